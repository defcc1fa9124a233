// Calls the shared library; exit code 0 where it answers.

extern "C" int CountEstimators();

int main() { return CountEstimators() == 7 ? 0 : 1; }
