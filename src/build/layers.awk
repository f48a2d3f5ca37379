# Report every `use` that points up or sideways. ORDER lists folders from the bottom; folders joined
# by commas are siblings and may not see each other.
# usage: awk -v ORDER="src/base src/io model/gas,model/des model/run" -f layers.awk FILES
BEGIN {
  n = split(ORDER, level, " ")
  for (i = 1; i <= n; i++) { k = split(level[i], d, ","); for (j = 1; j <= k; j++) rank[d[j]] = i }
}
FNR == 1 { dir = FILENAME; sub(/\/[^\/]*$/, "", dir); if (!(dir in rank)) { print dir ": no layer of that name"; bad = 1; rank[dir] = 0 } }
{ line = tolower($0); sub(/!.*/, "", line); gsub(/[(),:]+/, " ", line); m = split(line, t, " ") }
m == 2 && t[1] == "module" {
  if (t[2] in home) { print FILENAME ": " home[t[2]] " has a module " t[2] " too"; bad = 1 }
  home[t[2]] = dir
}
m >= 2 && t[1] == "use" && t[2] != "intrinsic" { c++; who[c] = FILENAME ":" FNR; from[c] = dir; what[c] = t[2] }
END {
  for (i = 1; i <= c; i++) {
    h = home[what[i]]
    if (h != "" && h != from[i] && rank[h] >= rank[from[i]]) { print who[i] ": " from[i] " may not use " what[i] " of " h; bad = 1 }
  }
  exit bad
}
