# SPDX-License-Identifier: BSD-3-Clause
# True poses, mapped poses, truth before, truth after, compare.csv: how many changes were found, and
# how many are none. A place is that of a true change within 0.3 m, in the frame in which the first
# poses fall upon each other.
BEGIN { FS = "," }
function near(x, y, xs, ys, n,  i) {
  for (i = 1; i <= n; i++) if ((x - xs[i]) ^ 2 + (y - ys[i]) ^ 2 < 0.09) return i
  return 0
}
FNR == 1 { file++; next }
FNR == 2 && file == 1 { true_x = $2; true_y = $3; true_yaw = $4 }
FNR == 2 && file == 2 {
  turn = true_yaw - $4
  c = cos(turn); s = sin(turn)
  shift_x = true_x - c * $2 + s * $3
  shift_y = true_y - s * $2 - c * $3
}
file == 3 && $1 == "tree" { bx[++nb] = $2; by[nb] = $3 }
file == 4 && $1 == "tree" { ax[++na] = $2; ay[na] = $3 }
file == 5 && !known {
  known = 1
  for (i = 1; i <= nb; i++) if (!near(bx[i], by[i], ax, ay, na)) { gx[++ng] = bx[i]; gy[ng] = by[i] }
  for (i = 1; i <= na; i++) if (!near(ax[i], ay[i], bx, by, nb)) { nx[++nn] = ax[i]; ny[nn] = ay[i] }
}
file == 5 {
  compared++
  if ($1 == "unchanged" || $1 == "not_seen") next
  x = c * $7 - s * $8 + shift_x; y = s * $7 + c * $8 + shift_y
  right = ($1 == "missing" && near(x, y, gx, gy, ng)) || ($1 == "new" && near(x, y, nx, ny, nn))
  if (right) hits++; else wrong++
}
END {
  printf "%d true changes, %d found, %d false of %d compared: precision %s, recall %s, false %.2f %%\n",
    ng + nn, hits, wrong, compared, hits + wrong ? sprintf("%.3f", hits / (hits + wrong)) : "-",
    ng + nn ? sprintf("%.3f", hits / (ng + nn)) : "-", 100 * wrong / compared
}
