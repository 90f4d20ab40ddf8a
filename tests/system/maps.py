# SPDX-License-Identifier: BSD-3-Clause
"""Map folders for tests: written as `orchard map` writes them, and read."""
import csv
import json
import os

HEADER = "id,class,x_m,y_m,n,roc_mean,probability,se_x_m,se_y_m,width_m,row,position,width_sd_m"


def landmark(number, x_m, y_m, row="", position="", width_m=0.12, kind="tree", num=20):
    """A line of map.csv."""
    roc = 0.9 if kind == "tree" else 0.1
    return f"{number},{kind},{x_m:.4f},{y_m:.4f},{num},{roc},0.990,0.005,0.005,{width_m:.4f},{row},{position},0.001"


def datum(latitude_deg, longitude_deg, altitude_m=0.0, yaw_rad=0.0, x_m=0.0, y_m=0.0):
    """The georeference of a map."""
    return {"latitude_deg": latitude_deg, "longitude_deg": longitude_deg, "altitude_m": altitude_m, "x_m": x_m, "y_m": y_m,
            "yaw_rad": yaw_rad, "residual_rms_m": 0.02}


def write_map(folder, landmarks, path=(), georeference=None, first_utime=1775000000000000, period_us=1000000, **summary):
    """map.csv of lines of landmark(), trajectory.csv of (x, y, yaw) once a period, summary.json."""
    os.makedirs(folder, exist_ok=True)
    with open(folder + "/map.csv", "w", encoding="ascii") as file:
        file.write(HEADER + "\n")
        file.writelines(line + "\n" for line in landmarks)
    path = list(path)
    if path:
        with open(folder + "/trajectory.csv", "w", encoding="ascii") as file:
            file.write("utime_us,x_m,y_m,yaw_rad\n")
            for k, (x_m, y_m, yaw_rad) in enumerate(path):
                file.write(f"{first_utime + k * period_us},{x_m:.4f},{y_m:.4f},{yaw_rad:.6f}\n")
    if georeference:
        summary["georeference"] = georeference
    with open(folder + "/summary.json", "w", encoding="ascii") as file:
        json.dump(summary, file)
    return folder


def rows_of(path):
    """The rows of a CSV, as text."""
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))
