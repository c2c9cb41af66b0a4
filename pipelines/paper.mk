# The paper's experiment in our reading of it (docs/reproduction.md says why each value).
# Odometry edges carry one hand-set covariance, several times looser than the odometry's real error.
paper.ingest    := --dimension 2 --keep-every 10 --sigma-translation 0.3 --sigma-rotation 0.05
paper.construct := --split middle --radius 3 --heading 30 --incorrect-rate 0.1 --incorrect-distance 10 \
                   --landmark-sigma-translation 0.1 --landmark-sigma-rotation 0.02
paper.pcm       := --test mahalanobis --probability 0.99
paper.multicut  := --delta 1
paper.optimize  :=
paper.evaluate  := --align se2 --scope joint
