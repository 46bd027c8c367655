//! What stands in an ambient file: header, layout, and the records that make sense.

use crate::codec::Layout;
use crate::components::Components;
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
    /// Where the components of its values stand in records.
    pub components: Components,
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
    let (header, data) = Header::parse(bytes, file).map_err(|e| e.problem())?;
    if let Some(format) = header.format()
        && format != FORMAT
    {
        return Err(format!("FORMAT={format} (expected {FORMAT})"));
    }
    let count = header.components();
    if !(Components::FEWEST..=Components::MOST).contains(&(count as usize)) {
        return Err(format!("NCOMP={count} (expected 3 to 24)"));
    }
    let start = data + MAGIC_BYTES;
    let magic = bytes.get(data..start).ok_or("the file ends after its header (expected magic number 561)")?;
    let magic = u16::from_be_bytes([magic[0], magic[1]]);
    let layout = Layout::of_magic(magic).ok_or_else(|| format!("magic number {magic} (expected 561 or 559)"))?;
    if layout == Layout::V559 && count != 3 {
        return Err(format!("NCOMP={count} (with magic number 559, expected 3)"));
    }
    Ok((header, layout, start))
}

/// Understands the bytes of a whole ambient file. Its components are taken in their order: three a pass.
pub fn scan(bytes: &[u8], file: &str) -> Result<Contents, String> {
    let (header, layout, start) = scan_header(bytes, file)?;
    let components = Components::in_order(header.components() as usize);
    Ok(understand(bytes, header, layout, start, components))
}

/// As [`scan`], but `components` says from the header where components stand; its error counts as one of the file.
pub(super) fn scan_as(
    bytes: &[u8],
    file: &str,
    components: impl FnOnce(&Header) -> Result<Components, String>,
) -> Result<Contents, String> {
    let (header, layout, start) = scan_header(bytes, file)?;
    let components = components(&header)?;
    Ok(understand(bytes, header, layout, start, components))
}

fn understand(bytes: &[u8], header: Header, layout: Layout, start: usize, components: Components) -> Contents {
    let (records, damaged, torn) = records(&bytes[start..], layout, &components);
    Contents { header, layout, components, start, records, damaged, torn }
}

/// The plausible records in `bytes`, the number of others, and the length of what remains at the end.
pub(super) fn records(bytes: &[u8], layout: Layout, components: &Components) -> (Vec<Record>, usize, usize) {
    let whole = bytes.chunks_exact(layout.record_bytes(components));
    let (count, rest) = (whole.len(), whole.remainder().len());
    let records: Vec<Record> = whole.map(|b| layout.decode(b, components)).filter(Record::is_plausible).collect();
    let damaged = count - records.len();
    (records, damaged, rest)
}
