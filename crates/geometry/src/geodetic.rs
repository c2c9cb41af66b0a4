//! NCLT's local frame: x north, y east, z down, in metres.
//!
//! N. Carlevaris-Bianco, A. K. Ushani, R. M. Eustice, "University of Michigan North Campus long-term vision and lidar dataset",
//! IJRR 35(9), 2016, gives the local linearisation of latitude and longitude about one origin, with the equatorial and polar
//! radius of the Earth, 6378135 m and 6356750 m:
//!
//! ```text
//! x = r_ns sin(latitude - latitude_0),   y = r_ew cos(latitude_0) sin(longitude - longitude_0)
//! r_ns = (r_e r_p)^2 / d^(3/2),   r_ew = r_e^2 / d^(1/2),   d = (r_e cos(latitude_0))^2 + (r_p sin(latitude_0))^2
//! ```

/// Latitude and longitude of the origin in degrees, its altitude in metres.
const ORIGIN: [f64; 3] = [42.293_227, -83.709_657, 270.0];
/// Equatorial and polar radius of the Earth, metres.
const RADII: [f64; 2] = [6_378_135.0, 6_356_750.0];

/// Metres per radian of latitude and of longitude at the origin.
fn scales() -> [f64; 2] {
    let (sine, cosine) = ORIGIN[0].to_radians().sin_cos();
    let [equatorial, polar] = RADII;
    let square = (equatorial * cosine).powi(2) + (polar * sine).powi(2);
    [(equatorial * polar).powi(2) / square.powf(1.5), equatorial.powi(2) / square.sqrt() * cosine]
}

/// North, east and down, metres, of a latitude and a longitude in radians and an altitude in metres.
pub fn to_local([latitude, longitude, altitude]: [f64; 3]) -> [f64; 3] {
    let [north, east] = scales();
    [
        north * (latitude - ORIGIN[0].to_radians()).sin(),
        east * (longitude - ORIGIN[1].to_radians()).sin(),
        ORIGIN[2] - altitude,
    ]
}

/// The inverse of [`to_local`], for positions within some thousand kilometres of the origin.
pub fn from_local([x, y, z]: [f64; 3]) -> [f64; 3] {
    let [north, east] = scales();
    [ORIGIN[0].to_radians() + (x / north).asin(), ORIGIN[1].to_radians() + (y / east).asin(), ORIGIN[2] - z]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_degree_is_as_long_as_on_the_ellipsoid_and_positions_come_back() {
        let degree = 1.0_f64.to_radians();
        let [latitude, longitude, altitude] = from_local([0.0; 3]);
        let [north, east, down] = to_local([latitude + degree, longitude + degree, altitude + 5.0]);
        // At 42.3 degrees north a degree of latitude has 111.08 km, one of longitude 82.46 km.
        assert!(
            (north - 111_080.0).abs() < 50.0 && (east - 82_460.0).abs() < 50.0 && down == -5.0,
            "{north} {east}"
        );
        for local in [[107.7, -333.4, 1.2], [-4000.0, 2500.0, -30.0]] {
            let again = to_local(from_local(local));
            assert!(local.iter().zip(again).all(|(a, b)| (a - b).abs() < 1e-8), "{again:?}");
        }
    }
}
