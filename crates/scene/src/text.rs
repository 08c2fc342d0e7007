//! View options as text, checked when they are parsed.

use basrelief_signals::MAX_PICTURE_PIXELS;

/// Size of a picture, `WIDTHxHEIGHT` \[pixels\].
///
/// # Errors
/// Text in another form. The error says the expected one.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let expected = "expected WIDTHxHEIGHT, each 1..=16384, such as 640x480";
    let (width, height) = text.split_once(['x', 'X']).ok_or(expected)?;
    let side = |s: &str| s.trim().parse::<u32>().ok().filter(|n| (1..=16384).contains(n)).ok_or(expected);
    let size = [side(width)?, side(height)?];
    if size.map(u64::from).iter().product::<u64>() > MAX_PICTURE_PIXELS {
        return Err(format!("expected at most {MAX_PICTURE_PIXELS} pixels, such as 3840x2160"));
    }
    Ok(size)
}

/// A finite number.
///
/// # Errors
/// Text in another form. The error says the expected one.
pub fn finite(text: &str) -> Result<f64, String> {
    text.parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(|| "expected a finite number".into())
}

/// Two angles, `AROUND,UP` \[degrees\].
///
/// # Errors
/// Text in another form. The error says the expected one.
pub fn angles(text: &str) -> Result<[f64; 2], String> {
    let expected = "expected AROUND,UP, two angles in degrees such as 30,-10";
    let (around, up) = text.split_once(',').ok_or(expected)?;
    Ok([finite(around.trim()).map_err(|_| expected)?, finite(up.trim()).map_err(|_| expected)?])
}

/// A direction in world space, `X,Y,Z`.
///
/// # Errors
/// Text in another form. The error says the expected one.
pub fn direction(text: &str) -> Result<[f64; 3], String> {
    let expected = "expected X,Y,Z, not all zero, such as 0.4,0.8,0.45";
    let parts: Vec<f64> = text.split(',').map(|p| finite(p.trim())).collect::<Result<_, _>>().map_err(|_| expected)?;
    let vector: [f64; 3] = parts.try_into().map_err(|_| expected)?;
    if vector.iter().all(|c| *c == 0.0) { Err(expected.into()) } else { Ok(vector) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_checked_where_they_are_given() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        assert!(size("0x480").is_err() && size("640").is_err() && size("99999x2").is_err() && size("16384x16384").is_err());
        assert_eq!(direction("1, -2,3.5"), Ok([1.0, -2.0, 3.5]));
        assert!(direction("0,0,0").is_err() && direction("1,2").is_err() && direction("1,NaN,2").is_err());
        assert_eq!(angles("30, -10.5"), Ok([30.0, -10.5]));
        assert!(angles("30").is_err() && angles("30,inf").is_err() && angles("1,2,3").is_err());
    }
}
