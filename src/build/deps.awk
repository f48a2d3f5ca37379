# Dependencies of Fortran sources for GNU make: what each object needs before it compiles, and the
# objects each program is linked from.
# usage: awk -v B=build/release -f deps.awk FILES          (a file may lie in B itself)
function object(f) { if (index(f, B "/") == 1) f = substr(f, length(B) + 2); sub(/\.f90$/, ".o", f); return B "/" f }
function collect(o,   k, m, i) {          # all objects that o needs, itself included, into `all`
  if (o in seen) return
  seen[o] = 1; all = all " " o
  k = split(need[o], m, " ")
  for (i = 1; i <= k; i++) if (m[i] in home) collect(home[m[i]])
}
{ line = tolower($0); sub(/!.*/, "", line); gsub(/[(),:]+/, " ", line); n = split(line, t, " ") }
n == 2 && t[1] == "module" {
  if (t[2] in home) print "two modules are named " t[2] ": " home[t[2]] " and " object(FILENAME) > "/dev/stderr"
  home[t[2]] = object(FILENAME)
}
n == 2 && t[1] == "program"                    { main[object(FILENAME)] = 1 }
n >= 2 && t[1] == "use" && t[2] != "intrinsic" { need[object(FILENAME)] = need[object(FILENAME)] " " t[2] }
END {
  for (o in need) {
    k = split(need[o], m, " "); s = ""
    for (i = 1; i <= k; i++) if (m[i] in home && home[m[i]] != o && index(s " ", " " home[m[i]] " ") == 0) s = s " " home[m[i]]
    if (s != "") print o ":" s
  }
  for (o in main) {
    for (x in seen) delete seen[x]
    all = ""; collect(o); p = o; sub(/\.o$/, "", p)
    print p ":" all
  }
}
