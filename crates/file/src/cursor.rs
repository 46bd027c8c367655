//! Portable values from bytes in memory: the fast way through octrees, meshes and ambient records.

use crate::portable::{FLOAT_BYTES, decode_float, integer};

/// A place in a byte string, moving forward as values are read. Every reader answers `None` if the bytes end.
#[derive(Clone, Copy, Debug)]
pub struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    /// Starts at the first byte.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// Offset of the next byte from the start.
    pub fn position(&self) -> usize {
        self.at
    }

    /// What has not been read yet.
    pub fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// True after the last byte.
    pub fn is_at_end(&self) -> bool {
        self.at == self.bytes.len()
    }

    /// The next n bytes.
    #[inline]
    pub fn take(&mut self, n: usize) -> Option<&'a [u8]> {
        let part = self.rest().get(..n)?;
        self.at += n;
        Some(part)
    }

    /// The next bytes as an array.
    #[inline]
    pub fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let part = *self.rest().first_chunk()?;
        self.at += N;
        Some(part)
    }

    /// One byte.
    #[inline]
    pub fn byte(&mut self) -> Option<u8> {
        self.array().map(|[b]| b)
    }

    /// An `I(n)`, n at most 8 (`None` for more).
    #[inline]
    pub fn int(&mut self, n: usize) -> Option<i64> {
        if n > 8 { None } else { self.take(n).map(integer) }
    }

    /// Four bytes as an unsigned number, most significant first.
    #[inline]
    pub fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_be_bytes)
    }

    /// A string without its NUL.
    pub fn string(&mut self) -> Option<&'a [u8]> {
        let length = self.rest().iter().position(|&b| b == 0)?;
        let text = self.take(length);
        self.at += 1;
        text
    }

    /// An `F`.
    #[inline]
    pub fn float(&mut self) -> Option<f64> {
        self.array::<FLOAT_BYTES>().map(decode_float)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn values_follow_each_other() {
        let bytes = b"\x01\x1ft.rad\0\0\xff\xff\x3f\xff\xff\xff\x00\x00\x00\x00\x0c\x02";
        let mut c = Cursor::new(bytes);
        assert_eq!(c.int(2), Some(287));
        assert_eq!(c.string(), Some(&b"t.rad"[..]));
        assert_eq!(c.string(), Some(&b""[..]));
        assert_eq!(c.int(2), Some(-1));
        assert_eq!(c.float(), Some(0.5));
        assert_eq!(c.u32(), Some(12));
        assert_eq!(c.float(), None);
        assert_eq!(c.byte(), Some(2));
        assert!(c.is_at_end());
        assert_eq!(c.byte(), None);
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(bytes in proptest::collection::vec(any::<u8>(), 0..64), steps in proptest::collection::vec(0usize..12, 0..32)) {
            let mut c = Cursor::new(&bytes);
            for s in steps {
                match s {
                    0 => _ = c.string(),
                    1 => _ = c.float(),
                    2 => _ = c.u32(),
                    n => _ = c.int(n - 2),
                }
                prop_assert!(c.position() <= bytes.len());
            }
        }
    }
}
