//! What stands in an ambient file: header, layout, and the records that make sense.

use crate::codec::{Layout, RECORD_BYTES};
use crate::record::Record;
use ambit_file::Header;

/// The value of `FORMAT=` in the header.
pub const FORMAT: &str = "Radiance_ambval";

/// The bytes of the magic number.
const MAGIC_BYTES: usize = 2;

/// An ambient file in memory.
#[derive(Clone, Debug)]
pub struct Contents {
    /// The header.
    pub header: Header,
    /// The order of fields in its records.
    pub layout: Layout,
    /// Where the first record begins.
    pub start: usize,
    /// The records that are plausible, in order.
    pub records: Vec<Record>,
    /// How many were skipped because they are not.
    pub damaged: usize,
    /// Bytes of an incomplete record at the end.
    pub torn: usize,
}

/// Understands the start of an ambient file: its header, layout, and where the first record begins. The error says what
/// was found and what was expected.
pub fn scan_header(bytes: &[u8], file: &str) -> Result<(Header, Layout, usize), String> {
    let (header, data) = Header::parse(bytes, file).map_err(|e| e.to_string())?;
    if let Some(format) = header.format()
        && format != FORMAT
    {
        return Err(format!("FORMAT={format} (expected {FORMAT})"));
    }
    let channels = header.components();
    if channels != 3 {
        return Err(format!("NCOMP={channels} (spectral records are not supported, expected NCOMP=3)"));
    }
    let start = data + MAGIC_BYTES;
    let magic = bytes.get(data..start).ok_or("the file ends after its header (expected magic number 561)")?;
    let magic = u16::from_be_bytes([magic[0], magic[1]]);
    let layout = Layout::of_magic(magic).ok_or_else(|| format!("magic number {magic} (expected 561 or 559)"))?;
    Ok((header, layout, start))
}

/// Understands the bytes of a whole ambient file.
pub fn scan(bytes: &[u8], file: &str) -> Result<Contents, String> {
    let (header, layout, start) = scan_header(bytes, file)?;
    let (records, damaged, torn) = records(&bytes[start..], layout);
    Ok(Contents { header, layout, start, records, damaged, torn })
}

/// The plausible records in `bytes`, the number of others, and the length of what remains at the end.
pub(super) fn records(bytes: &[u8], layout: Layout) -> (Vec<Record>, usize, usize) {
    let (whole, rest) = bytes.as_chunks::<RECORD_BYTES>();
    let records: Vec<Record> = whole.iter().map(|b| layout.decode(b)).filter(Record::is_plausible).collect();
    let damaged = whole.len() - records.len();
    (records, damaged, rest.len())
}
