//! What of a record's light the last bounces brought, in an ambient file that has no field for it.
//!
//! A file's reals have 31 bits of mantissa, of which radii and gradients, of single precision, fill 24. What is left over is
//! read by no program, for every one rounds to single precision. There stand, for each channel, the shares of the light
//! that the last bounce and the last two brought. Records of other programs have nothing there, and so tell of no bounces.

use crate::light::APART;
use crate::record::Record;
use ambit_base::{Rgb, hash_point};
use ambit_file::SPARE;

/// How many reals of a record have room.
pub(crate) const CARRIERS: usize = 6;

/// Thresholds of rounding keep off 0 and 1 by this, so that what has been read is written as it was.
const MARGIN: f64 = 0.01;

/// Shares of the three channels, first those of the last bounce, then those of the last two; in parts of [`SPARE`].
pub(crate) type Shares = [u8; CARRIERS];

/// The shares of a record. In a calculation by wavelength those of a channel are its mean over all passes.
///
/// They are rounded up or down at random, by what hangs on the point, so that they are right in the mean: records that
/// stand side by side have much the same. What the last bounces took away, as they do from a great ambient value, is left
/// out.
pub(crate) fn shares(record: &Record) -> Shares {
    let mut shares = [0; CARRIERS];
    if record.late.is_empty() {
        return shares;
    }
    let total: Rgb = record.values().sum();
    let threshold = (hash_point(record.position) >> 11) as f64 / (1_u64 << 53) as f64;
    let threshold = MARGIN + (1.0 - 2.0 * MARGIN) * threshold;
    for (k, share) in shares.iter_mut().enumerate() {
        let (which, channel) = (k / 3, k % 3);
        let late: f32 = record.late.iter().map(|late| late[which][channel]).sum();
        let part = f64::from(late / total[channel]);
        if part > 0.0 {
            *share = (part.min(1.0) * f64::from(SPARE) + threshold) as u8;
        }
    }
    shares
}

/// What the last bounces brought in each pass, by the shares that a file tells; nothing where it tells none.
pub(crate) fn late(shares: Shares, record: &Record) -> Box<[[Rgb; APART]]> {
    if shares == [0; CARRIERS] {
        return Box::default();
    }
    let part = |which: usize| Rgb::from_array([0, 1, 2].map(|c| f32::from(shares[3 * which + c]) / f32::from(SPARE)));
    let parts: [Rgb; APART] = std::array::from_fn(part);
    record.values().map(|value| parts.map(|part| value * part)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codec::Layout;
    use crate::components::Components;
    use ambit_base::DVec3;

    fn record(x: f64, gradient: f32, late: [Rgb; APART]) -> Record {
        Record {
            position: DVec3::new(x, 2.0, 3.0),
            normal: DVec3::Z,
            u: DVec3::X,
            level: 0,
            weight: 1.0,
            radii: [0.5, 1.0],
            gradient: [gradient, -gradient],
            rotation: [0.0, 0.25],
            corral: 0,
            value: Rgb::new(4.0, 2.0, 1.0),
            further: Box::default(),
            late: [late].into(),
        }
    }

    fn read_again(record: &Record) -> Record {
        let rgb = Components::default();
        Layout::CURRENT.decode(&Layout::CURRENT.encode(record, &rgb), &rgb)
    }

    #[test]
    fn a_file_tells_what_the_last_bounces_brought() {
        let late = [Rgb::new(0.4, 1.0, 0.0), Rgb::new(3.0, 2.0, 0.25)];
        let first = read_again(&record(1.0, 0.1, late).quantised(&Components::default()));
        let step = 1.0 / f32::from(SPARE);
        for (read, known) in first.late[0].iter().zip(late) {
            let off = (*read - known).abs() / first.value;
            assert!(off.max_element() <= step + 1.0 / 128.0, "{read} instead of {known}");
        }
        assert!(first.is_plausible());
        // Written once more it stays as it is.
        assert_eq!(read_again(&first), first);
    }

    #[test]
    fn other_programs_read_what_they_always_did() {
        let late = [Rgb::new(0.4, 1.0, 0.0), Rgb::new(3.0, 2.0, 0.25)];
        for gradient in [0.0, 0.1, -3e-5] {
            let (with, without) = (record(1.0, gradient, late), record(1.0, gradient, Default::default()));
            let bare = Record { late: Box::default(), ..read_again(&with) };
            assert_eq!(bare, read_again(&without), "gradient {gradient}");
            assert!(read_again(&without).late.is_empty());
        }
    }

    #[test]
    fn shares_are_right_in_the_mean() {
        let share = 0.1;
        let mean = |n: u32| {
            let late = |k| read_again(&record(0.01 * f64::from(k), 0.1, [Rgb::new(4.0, 2.0, 1.0) * share; APART])).late;
            (0..n).map(|k| late(k).first().map_or(0.0, |l| l[0].y / 2.0)).sum::<f32>() / n as f32
        };
        // A step is 0.016; the error of the mean of 2000 is two hundredths of that.
        assert!((mean(2000) - share).abs() < 1e-3, "{}", mean(2000));
    }
}
