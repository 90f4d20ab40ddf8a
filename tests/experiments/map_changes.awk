# SPDX-License-Identifier: BSD-3-Clause
# True poses, mapped poses, truth before, truth after, compare.csv: a line `truth,KIND,NUMBER` for
# each kind of change, a line `claim,KIND,CONFIDENCE,VERDICT` for each change that compare claims, and
# `compared,NUMBER`. A claim is right when a true change of its kind lies within 0.3 m, in the frame in
# which the first poses fall upon each other; `object` when a post or bush came or went within 1 m of
# it; else false. What keeps its width and stands within 1.7 m of where it stood has moved.
BEGIN { FS = "," }
function near(x, y, xs, ys, n, within,  i) {
  for (i = 1; i <= n; i++) if ((x - xs[i]) ^ 2 + (y - ys[i]) ^ 2 < within * within) return i
  return 0
}
function truly(kind, x, y) { n_true[kind]++; tx[kind, n_true[kind]] = x; ty[kind, n_true[kind]] = y }
function is_true(kind, x, y,  i) {
  for (i = 1; i <= n_true[kind]; i++)
    if (!taken[kind, i] && (x - tx[kind, i]) ^ 2 + (y - ty[kind, i]) ^ 2 < 0.09) {
      taken[kind, i] = 1
      return 1
    }
  return 0
}
function know_truth(  i, j) {
  for (i = 1; i <= nb; i++) {
    j = near(bx[i], by[i], ax, ay, na, 0.02)
    if (j && aw[j] - bw[i] > 0.0015) truly("grown", ax[j], ay[j])
    if (j) { stays[j] = 1; continue }
    for (j = 1; j <= na; j++)
      if (!stays[j] && (aw[j] - bw[i]) ^ 2 < 2.3e-8 && (ax[j] - bx[i]) ^ 2 + (ay[j] - by[i]) ^ 2 < 2.9 &&
          !near(ax[j], ay[j], bx, by, nb, 0.02)) break
    if (j <= na) { truly("moved", ax[j], ay[j]); stays[j] = 1 } else truly("missing", bx[i], by[i])
  }
  for (j = 1; j <= na; j++) if (!stays[j]) truly("new", ax[j], ay[j])
  for (i = 1; i <= nob; i++) if (!near(obx[i], oby[i], oax, oay, noa, 0.02)) { ox[++no] = obx[i]; oy[no] = oby[i] }
  for (i = 1; i <= noa; i++) if (!near(oax[i], oay[i], obx, oby, nob, 0.02)) { ox[++no] = oax[i]; oy[no] = oay[i] }
}
FNR == 1 { file++; next }
FNR == 2 && file == 1 { true_x = $2; true_y = $3; true_yaw = $4 }
FNR == 2 && file == 2 {
  turn = true_yaw - $4
  c = cos(turn); s = sin(turn)
  shift_x = true_x - c * $2 + s * $3
  shift_y = true_y - s * $2 - c * $3
}
file == 3 && $1 == "tree" { bx[++nb] = $2; by[nb] = $3; bw[nb] = $4 }
file == 4 && $1 == "tree" { ax[++na] = $2; ay[na] = $3; aw[na] = $4 }
file == 3 && $1 == "object" { obx[++nob] = $2; oby[nob] = $3 }
file == 4 && $1 == "object" { oax[++noa] = $2; oay[noa] = $3 }
file == 5 && !known { known = 1; know_truth() }
file == 5 {
  compared++
  if ($1 == "unchanged" || $1 == "not_seen") next
  x = c * $7 - s * $8 + shift_x; y = s * $7 + c * $8 + shift_y
  verdict = is_true($1, x, y) ? "right" : near(x, y, ox, oy, no, 1.0) ? "object" : "false"
  print "claim," $1 "," $2 "," verdict
  if (verdict == "false") printf "%s at %.2f, %.2f (%s) is none\n", $1, x, y, $2 > "/dev/stderr"
}
END {
  for (kind in n_true) {
    print "truth," kind "," n_true[kind]
    for (i = 1; i <= n_true[kind]; i++)
      if (!taken[kind, i]) printf "%s at %.2f, %.2f was not found\n", kind, tx[kind, i], ty[kind, i] > "/dev/stderr"
  }
  print "compared," compared
}
