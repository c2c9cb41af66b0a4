//! Lowest known costs, for residuals by the logarithm.

/// Graph and cost.
pub(crate) const BEST_KNOWN: [(&str, f64); 15] = [
    ("smallGrid3D", 1_035.850_664_72),
    ("CSAIL", 40.550_883_344_1),
    ("MIT", 41.206_947_040_8),
    ("intel_carlone", 215.838_121_148),
    ("intel", 45.004_233_087_9),
    ("ringCity", 262.817_892_448),
    ("kitti_00", 98.322_138_230_3),
    ("M3500", 137.914_878_247),
    ("M3500a", 912.191_624_430),
    ("manhattanOlson3500", 146.078_728_608),
    ("parking-garage", 1.268_384_799_26),
    ("sphere2500", 1_351.401_925_85),
    ("sphere_a", 2_988_337.510_53),
    ("torus3D", 24_235.273_758_8),
    ("city10000", 511.987_450_599),
];
