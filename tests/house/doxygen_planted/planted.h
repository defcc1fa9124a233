/// A comment that Doxygen obeys. \no_such_command
struct Planted {};
