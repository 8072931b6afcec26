#!/usr/bin/env python3
"""Form error, cutting force and actual feed along the path of a job.

    error_along_the_path.py JOB.toml [PICTURE.png]
"""
import sys

import matplotlib
import numpy

import camber

# %% Predict
if len(sys.argv) not in (2, 3):
    sys.exit(__doc__)
job = camber.read_job(sys.argv[1])
result = camber.predict(job, feed=True)
if result.doubts:
    sys.exit("\n".join(result.doubts))
print(f"{result.form_error_um.p95:.2f} um (95 % of the surface), {result.force_max_N:.1f} N")

# %% The surface that each line of the program leaves: largest excess and largest gouge
points = result.form_error
lines = numpy.unique(points.block[points.block > 0])
excess = numpy.full(lines.size, -numpy.inf)
gouge = numpy.full(lines.size, numpy.inf)
known = points.block > 0
index = numpy.searchsorted(lines, points.block[known])
numpy.maximum.at(excess, index, points.error_um[known])
numpy.minimum.at(gouge, index, points.error_um[known])

# %% When each of them is cut
forces, feed = result.forces, result.feed
at_s = numpy.array([forces.t_s[forces.block == line].mean() if (forces.block == line).any() else numpy.nan
                    for line in lines])

# %% Plot
if len(sys.argv) == 3:
    matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of what it draws with)

figure, (error, force, speed) = plt.subplots(3, sharex=True, figsize=(10, 8), layout="constrained")
error.vlines(at_s, gouge, excess, linewidth=2)
error.axhline(0, color="black", linewidth=0.5)
error.set_ylabel("form error, µm")
force.plot(forces.t_s, forces.f_max_N, linewidth=0.7)
force.set_ylabel("lateral force, N")
speed.plot(feed.t_s, feed.feed_mm_per_min, linewidth=0.7)
speed.set_ylabel("actual feed, mm/min")
speed.set_xlabel("time, s")
figure.suptitle(job.program_path)
if len(sys.argv) == 3:
    figure.savefig(sys.argv[2], dpi=120)
else:
    plt.show()
