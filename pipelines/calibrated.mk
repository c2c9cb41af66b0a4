# The same experiment with an odometry covariance near the odometry's real error
# (posecut-ingest --stats measures it: step_error_forward_m, step_error_heading_rad).
calibrated.ingest    := --dimension 2 --keep-every 10 --sigma-translation 0.1 --sigma-rotation 0.02
calibrated.construct := $(paper.construct)
calibrated.pcm       := $(paper.pcm)
calibrated.multicut  := $(paper.multicut)
calibrated.optimize  := $(paper.optimize)
calibrated.evaluate  := $(paper.evaluate)
