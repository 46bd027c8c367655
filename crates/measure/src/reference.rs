//! Converged references and the file that keeps them.
//!
//! A reference is made of passes with different random numbers, whose means form two halves; their difference tells its
//! noise. The file is a matrix as Radiance's own programs write them: an information header, then 32-bit floats, least
//! byte first, one row of six a value: red, green and blue of either half (of the only half twice, if there is one only).
//! The header's lines say how it was made.

use crate::error::Error;
use crate::parts::{Part, cells};
use crate::score::finite;
use ambit_file::{Header, Picture, PixelSpace, Replacement, path_of};
use serde::{Deserialize, Serialize};
use std::io::Write;

/// Floats of one row.
const ROW: usize = 6;

/// Line of the header: sizes of the parts.
const PARTS: &str = "PARTS";

/// Line of the header: how many halves there are.
const HALVES: &str = "HALVES";

/// What results are compared with.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Views or sensors, in order.
    pub parts: Vec<Part>,
    /// Mean of the passes of the first half: radiance in W/(sr·m²) or irradiance in W/m², per channel.
    pub a: Vec<[f32; 3]>,
    /// The same of the second half; `None` if there is one half only, whose noise is not known.
    pub b: Option<Vec<[f32; 3]>>,
    /// Lines `NAME=value` that say how it was made.
    pub header: Vec<String>,
    /// Which values are left out of all comparisons and of the mean; none if empty. Not kept in files.
    pub ignored: Vec<bool>,
}

/// How far a reference is from the truth by noise, as its halves tell; relative to its mean.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// Root mean square over all channels of all values of the mean of both halves.
    pub rms: f64,
    /// The least RMS error of a result that stands out from it by two standard deviations.
    pub floor: f64,
}

impl Reference {
    /// Reads a reference from its own file, or from a picture (of which neither noise nor origin is known).
    pub fn open(file: &str) -> Result<Self, Error> {
        let bad = |problem: String| Error::Reference { file: file.to_owned(), problem };
        let bytes = std::fs::read(path_of(file)).map_err(|source| Error::File { file: file.to_owned(), source })?;
        let (header, start) = Header::parse(&bytes, file).map_err(|e| bad(e.to_string()))?;
        if header.format() != Some("float") {
            return Self::from_picture(&Picture::read(&bytes[..], file).map_err(|e| bad(e.to_string()))?, file);
        }
        let one = |name: &'static str| header.values(name).last();
        if one("NCOMP") != Some("6") || one("BigEndian").unwrap_or("0") != "0" {
            return Err(bad("not written by this program (expected NCOMP=6, BigEndian=0)".to_owned()));
        }
        let sizes = one(PARTS).ok_or_else(|| bad(format!("no line {PARTS}= in its header")))?;
        let parts: Option<Vec<Part>> = sizes.split_whitespace().map(parse_part).collect();
        let parts = parts.ok_or_else(|| bad(format!("{PARTS}={sizes} (expected sizes like 128x128)")))?;
        let count: usize = parts.iter().map(|p| p.len()).sum();
        let (floats, rest) = bytes[start..].as_chunks::<4>();
        if floats.len() != count * ROW || !rest.is_empty() {
            return Err(bad(format!("{} bytes of data (expected {})", bytes.len() - start, count * ROW * 4)));
        }
        let (rows, _) = floats.as_chunks::<ROW>();
        let half = |first: usize| rows.iter().map(|r| [0, 1, 2].map(|c| f32::from_le_bytes(r[first + c]))).collect();
        let (a, b): (Vec<_>, Vec<_>) = (half(0), half(3));
        finite(&a, &format!("reference {file}"))?;
        finite(&b, &format!("reference {file}"))?;
        let b = if one(HALVES) == Some("1") { None } else { Some(b) };
        let own = ["NROWS=", "NCOLS=", "NCOMP=", "BigEndian=", "FORMAT=", PARTS, HALVES];
        let lines = header.lines().skip(1).map(|l| String::from_utf8_lossy(l).into_owned());
        let header = lines.filter(|l| !own.iter().any(|o| l.starts_with(o))).collect();
        Ok(Self { parts, a, b, header, ignored: Vec::new() })
    }

    /// A picture as a reference.
    fn from_picture(picture: &Picture, file: &str) -> Result<Self, Error> {
        let (part, values) = radiance(picture, file)?;
        let header = vec![format!("PICTURE={file}")];
        Ok(Self { parts: vec![part], a: values, b: None, header, ignored: Vec::new() })
    }

    /// One reference of several, their views in order. Noise is known if it is of all.
    pub fn join(all: Vec<Self>) -> Option<Self> {
        all.into_iter().reduce(|mut one, next| {
            one.parts.extend(next.parts);
            one.a.extend(next.a);
            one.b = one.b.zip(next.b).map(|(b, more)| [b, more].concat());
            one.header.extend(next.header);
            one
        })
    }

    /// Writes the file whole or not at all.
    pub fn write(&self, file: &str) -> Result<(), Error> {
        let failed = |source| Error::File { file: file.to_owned(), source };
        let mut header = Header::new();
        header.extend(&self.header);
        let sizes: Vec<String> = self.parts.iter().map(|p| format!("{}x{}", p.width, p.height)).collect();
        header.push(format!("{PARTS}={}", sizes.join(" ")));
        header.push(format!("{HALVES}={}", if self.b.is_some() { 2 } else { 1 }));
        header.push(format!("NROWS={}", self.a.len()));
        header.extend(["NCOLS=1", "NCOMP=6", "BigEndian=0", "FORMAT=float"]);
        let mut out = Replacement::create(&path_of(file)).map_err(failed)?;
        header.write(&mut out).map_err(failed)?;
        for (a, b) in self.a.iter().zip(self.b.as_ref().unwrap_or(&self.a)) {
            for v in a.iter().chain(b) {
                out.write_all(&v.to_le_bytes()).map_err(failed)?;
            }
        }
        out.commit().map_err(failed)
    }

    /// The value of a line of the header.
    pub fn line(&self, name: &str) -> Option<&str> {
        self.header.iter().find_map(|l| l.strip_prefix(name)?.strip_prefix('='))
    }

    /// The reference over cells of `side` × `side` pixels.
    #[must_use]
    pub fn cells(&self, side: u32) -> Self {
        let each = |values: &[[f32; 3]]| -> Vec<[f32; 3]> {
            let mut start = 0;
            let small = self.parts.iter().flat_map(|p| {
                start += p.len();
                cells(*p, &values[start - p.len()..start], side).1
            });
            small.collect()
        };
        let parts = self.parts.iter().map(|p| cells(*p, &vec![[0.0; 3]; p.len()], side).0).collect();
        Self {
            parts,
            a: each(&self.a),
            b: self.b.as_deref().map(each),
            header: self.header.clone(),
            ignored: Vec::new(),
        }
    }

    /// Leaves out the values of which either half has a channel above `times` its mean: lamps that are seen directly,
    /// and mirror images of them. One such pixel can weigh more than all others together.
    #[must_use]
    pub fn without_bright(mut self, times: f64) -> Self {
        let limit = times * self.mean();
        let bright = |v: &[f32; 3]| v.iter().any(|c| *c as f64 > limit);
        self.ignored =
            self.a.iter().zip(self.b.as_ref().unwrap_or(&self.a)).map(|(a, b)| bright(a) || bright(b)).collect();
        self
    }

    /// Whether a value is compared.
    pub fn counts(&self, index: usize) -> bool {
        !self.ignored.get(index).copied().unwrap_or(false)
    }

    /// Mean over all channels of all values of both halves.
    pub fn mean(&self) -> f64 {
        let mean = |v: &[[f32; 3]]| {
            let counted = (0..v.len()).filter(|i| self.counts(*i));
            let (sum, count) =
                counted.fold((0.0, 0.0), |(s, n), i| (s + v[i].iter().map(|c| *c as f64).sum::<f64>(), n + 3.0));
            sum / f64::max(count, 1.0)
        };
        let a = mean(&self.a);
        self.b.as_deref().map_or(a, |b| f64::midpoint(a, mean(b)))
    }

    /// The noise, if it is known and the mean is positive.
    pub fn noise(&self) -> Option<Noise> {
        let b = self.b.as_ref().filter(|_| self.mean() > 0.0)?;
        let counted: Vec<usize> = (0..b.len()).filter(|i| self.counts(*i)).collect();
        let square = |i: &usize| (0..3).map(|c| (self.a[*i][c] as f64 - b[*i][c] as f64).powi(2)).sum::<f64>();
        let difference = counted.iter().map(square).sum::<f64>() / (3 * counted.len()) as f64;
        // Variance of either half: half of the difference's; of their mean: a quarter of it. The mean of (x − a)(x − b)
        // over n independent values has the standard deviation (variance of a half)/√n; channels are not independent.
        let floor = (2.0 * (difference / 2.0) / (counted.len() as f64).sqrt()).sqrt();
        Some(Noise { rms: (difference / 4.0).sqrt() / self.mean(), floor: floor / self.mean() })
    }
}

/// `128x96` as a size.
fn parse_part(text: &str) -> Option<Part> {
    let (width, height) = text.split_once('x')?;
    Some(Part { width: width.parse().ok()?, height: height.parse().ok()? }).filter(|p| !p.is_empty())
}

/// The size and radiance (W/(sr·m²)) of an RGBE picture, exposure undone; rows from the bottom up. `file` names it in
/// errors.
pub fn radiance(picture: &Picture, file: &str) -> Result<(Part, Vec<[f32; 3]>), Error> {
    let bad = |problem: &str| Error::Reference { file: file.to_owned(), problem: problem.to_owned() };
    if picture.space != PixelSpace::Rgb {
        return Err(bad("an XYZE picture (expected RGBE)"));
    }
    let (exposure, colour) = (picture.header.exposure(), picture.header.colour_correction());
    let scale = colour.map(|c| 1.0 / (exposure * c));
    if !scale.iter().all(|s| s.is_finite()) {
        return Err(bad("an EXPOSURE or COLORCORR of nothing in its header"));
    }
    let values = picture.pixels.iter().map(|p| {
        let p = p.to_array();
        [0, 1, 2].map(|c| (p[c] as f64 * scale[c]) as f32)
    });
    Ok((Part { width: picture.width, height: picture.height }, values.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two() -> Reference {
        let a = (0..6).map(|i| [1.0 + i as f32, 0.5, 0.25]).collect();
        let b = (0..6).map(|i| [1.0 + i as f32, 0.5, 0.75]).collect();
        Reference {
            parts: vec![Part { width: 3, height: 2 }],
            a,
            b: Some(b),
            header: vec!["PASSES=2".to_owned()],
            ignored: Vec::new(),
        }
    }

    #[test]
    fn a_file_holds_all_of_it() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("r.ref");
        let file = file.to_str().unwrap();
        for reference in [two(), Reference { b: None, ..two() }] {
            reference.write(file).unwrap();
            assert_eq!(Reference::open(file).unwrap(), reference);
        }
        assert_eq!(two().line("PASSES"), Some("2"));
        let whole = std::fs::read(file).unwrap();
        std::fs::write(file, &whole[..whole.len() - 4]).unwrap();
        assert!(Reference::open(file).unwrap_err().to_string().contains("bytes of data (expected 144)"));
        assert!(Reference::open("/no/such/file").unwrap_err().to_string().contains("No such file"));
    }

    #[test]
    fn noise_is_what_the_halves_tell() {
        // One of three channels differs by 0.5: mean square 0.25/3.
        let noise = two().noise().unwrap();
        let mean = (3.5 + 0.5 + 0.5) / 3.0;
        assert!((two().mean() - mean).abs() < 1e-9);
        assert!((noise.rms - (0.25_f64 / 3.0).sqrt() / 2.0 / mean).abs() < 1e-9, "{noise:?}");
        assert!(Reference { b: None, ..two() }.noise().is_none());
    }

    #[test]
    fn bright_values_can_be_left_out() {
        let mut lamp = two();
        lamp.a[2] = [1000.0; 3];
        assert!(lamp.mean() > 50.0);
        let without = lamp.without_bright(5.0);
        assert_eq!((0..6).filter(|i| !without.counts(*i)).collect::<Vec<_>>(), [2]);
        // The mean of 1, 2, 4, 5, 6 in red, 0.5 in green and blue.
        assert!((without.mean() - (3.6 + 1.0) / 3.0).abs() < 1e-6);
        assert!((without.noise().unwrap().rms - (0.25_f64 / 3.0).sqrt() / 2.0 / without.mean()).abs() < 1e-9);
    }

    #[test]
    fn views_are_joined_and_cells_averaged() {
        let joined = Reference::join(vec![two(), two()]).unwrap();
        assert_eq!((joined.parts.len(), joined.a.len()), (2, 12));
        let small = joined.cells(2);
        assert_eq!(small.parts, [Part { width: 2, height: 1 }; 2]);
        assert!((small.a[2][0] - 3.0).abs() < 1e-6 && (small.b.unwrap()[3][2] - 0.75).abs() < 1e-6);
    }

    #[test]
    fn pictures_are_references_without_known_noise() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("p.hdr");
        let mut header = Header::new();
        header.push("EXPOSURE=2");
        let pixels = vec![ambit_base::Rgb::splat(1.0); 4];
        let picture = Picture { header, width: 2, height: 2, space: PixelSpace::Rgb, pixels };
        picture.write(&mut std::fs::File::create(&file).unwrap()).unwrap();
        let reference = Reference::open(file.to_str().unwrap()).unwrap();
        assert!((reference.mean() - 0.5).abs() < 0.005 && reference.noise().is_none());
    }
}
