# The comments of a header as Doxygen reads them: "//" before what it documents, "///<" behind it, the first one the
# file's. Marks that Doxygen would obey are shown instead.
function shown(text) {
  gsub(/[\\@]/, "\\\\&", text)
  gsub(/&/, "\\&amp;", text)
  gsub(/</, "\\&lt;", text)
  gsub(/>/, "\\&gt;", text)
  gsub(/[#%]/, "\\\\&", text)
  gsub(/::/, "\\::", text)
  return text
}
NR == 1 && /^\/\// { print "/// \\file" }
{
  at = match($0, /(^|[ \t])\/\/( |$)/)
  if (!at) { behind = 0; print; next }
  column = at + (RLENGTH > 2 && substr($0, at, 1) != "/" ? 1 : 0)
  before = substr($0, 1, column - 1)
  text = shown(substr($0, column + 2))
  if (before ~ /[^ \t]/) { behind = column; print before "///<" text; next }
  if (behind == column) { print before "///<" text; next }
  behind = 0
  print before "///" text
}
