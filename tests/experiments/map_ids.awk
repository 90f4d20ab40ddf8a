# SPDX-License-Identifier: BSD-3-Clause
# True poses and mapped poses of the first drive, the same of the second, truth before, truth after,
# map.csv before, map.csv after: of the trees that stand where they stood and are in both maps, how
# many have another id, how many another row or position; how many landmarks of new trees have an id
# that the first map gave. A tree's landmark is the nearest within 0.4 m.
BEGIN { FS = "," }
FNR == 1 { file++; next }
FNR == 2 && file % 2 == 1 && file < 4 { true_x = $2; true_y = $3; true_yaw = $4 }
FNR == 2 && (file == 2 || file == 4) {
  c[file] = cos(true_yaw - $4); s[file] = sin(true_yaw - $4)
  dx[file] = true_x - c[file] * $2 + s[file] * $3
  dy[file] = true_y - s[file] * $2 - c[file] * $3
}
file == 5 && $1 == "tree" { bx[++nb] = $2; by[nb] = $3 }
file == 6 && $1 == "tree" { ax[++na] = $2; ay[na] = $3 }
file == 7 || file == 8 {
  f = file == 7 ? 2 : 4
  x = c[f] * $3 - s[f] * $4 + dx[f]; y = s[f] * $3 + c[f] * $4 + dy[f]
  if (file == 7) { given[$1] = 1; mx[++n7] = x; my[n7] = y; mid[n7] = $1; mnum[n7] = $11 "/" $12 }
  else { lx[++n8] = x; ly[n8] = y; lid[n8] = $1; lnum[n8] = $11 "/" $12 }
}
function nearest(x, y, xs, ys, n, within,  i, d, best, least) {
  best = 0; least = within * within
  for (i = 1; i <= n; i++) {
    d = (x - xs[i]) ^ 2 + (y - ys[i]) ^ 2
    if (d < least) { least = d; best = i }
  }
  return best
}
END {
  for (j = 1; j <= na; j++) {
    l = nearest(ax[j], ay[j], lx, ly, n8, 0.4)
    if (!l) continue
    if (nearest(ax[j], ay[j], bx, by, nb, 0.02)) {
      m = nearest(ax[j], ay[j], mx, my, n7, 0.4)
      if (!m) continue
      pairs++
      if (lid[l] != mid[m]) { ids++; printf "id %s was %s at %.2f, %.2f\n", lid[l], mid[m], ax[j], ay[j] > "/dev/stderr" }
      if (lnum[l] != mnum[m]) { numbers++; printf "number %s was %s at %.2f, %.2f\n", lnum[l], mnum[m], ax[j], ay[j] > "/dev/stderr" }
    } else if (lid[l] in given) { reused++; printf "new tree at %.2f, %.2f has the known id %s\n", ax[j], ay[j], lid[l] > "/dev/stderr" }
  }
  printf "ids,%d,%d,%d,%d\n", pairs, ids, numbers, reused
}
