# Report what the eye should not meet: in every file trailing blanks, tabs (Makefile and shell
# excepted) and a missing last newline; in Fortran long lines, files and procedures, a library used
# outside the one place that knows it, and words that mark unfinished work.
# usage: awk -f style.awk FILES
function report(message) { print file ":" line_number ": " message; bad = 1 }
function close_file() { if (fortran && line_number > file_limit) report("a file of " line_number " lines (at most " file_limit ")") }
function keep(library, homes) { only[library] = homes }
BEGIN {
  line_limit = 132; file_limit = 450; procedure_limit = 90
  keep("hdf5", "^src/io/hdf5_file"); keep("mpi", "^(src/(parallel|io)|tests)/"); keep("mpi_f08", "^(src/(parallel|io)|tests)/")
  heading = "^(pure |elemental |impure |recursive |module |integer|real|logical|character|type)*[^!'\"]*(subroutine|function) +[a-z]"
}
FNR == 1 { if (NR > 1) close_file(); file = FILENAME; fortran = file ~ /\.f90$/; start = 0 }
{ line_number = FNR }
/[ \t]$/ { report("blanks at the end of the line") }
/\t/ && file !~ /Makefile$|\.mk$/ { report("a tab") }
/\r/ { report("a carriage return") }
!fortran { next }
length($0) > line_limit { report("a line of " length($0) " characters (at most " line_limit ")") }
{ code = tolower($0); sub(/^ +/, "", code) }
code ~ /^!.*(todo|fixme|xxx|for now|placeholder)/ { report("unfinished") }
code ~ /^use[ ,]/ {
  name = code; sub(/^use(, *(non_)?intrinsic *::)? */, "", name); sub(/[^a-z0-9_].*/, "", name)
  if (name in only && file !~ only[name]) report("uses " name ", which belongs to " only[name])
}
code ~ /^end (subroutine|function)/ {
  if (start && FNR - start > procedure_limit) report("a procedure of " FNR - start " lines (at most " procedure_limit ")")
  start = 0
}
code !~ /^end/ && code ~ heading && !start { start = FNR }
END { close_file(); exit bad }
