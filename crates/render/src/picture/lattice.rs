//! The lattice of pixels that are traced first: lines with a sample every few pixels, every other line shifted by
//! half that (a quincunx).

/// Where the first samples are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Lattice {
    /// Horizontal spacing.
    pub(crate) across: u32,
    /// Vertical spacing.
    pub(crate) down: u32,
    /// Rows (counted from the bottom of the picture) of its lines, from the top down.
    pub(crate) lines: Vec<u32>,
    width: u32,
}

/// Greatest sample spacing in pixels.
const GREATEST: u32 = 16;

impl Lattice {
    /// The lattice of the lowest `height` rows of a picture for a spacing of so many pixels. Lines are √½ as far apart
    /// as the samples on them, roughly, so that the quincunx is even in all directions.
    pub(crate) fn new(width: u32, height: u32, spacing: u32) -> Self {
        let spacing = spacing.clamp(1, GREATEST);
        let (across, down) = ((140 * spacing + 49) / 99, (99 * spacing + 70) / 140);
        let mut lines = Vec::new();
        let mut next = height.checked_sub(1);
        while let Some(y) = next {
            lines.push(y);
            next = (y > 0).then(|| y.saturating_sub(down));
        }
        Self { across, down, lines, width }
    }

    /// The columns of the samples on line `n`, counted from 0 at the top.
    pub(crate) fn columns(&self, n: usize) -> impl Iterator<Item = u32> + use<> {
        let (width, across) = (self.width, self.across);
        let first = if n.is_multiple_of(2) { across } else { (across / 2).max(1) };
        let last = width.saturating_sub(1);
        let inner = (0..).map(move |i| first + i * across).take_while(move |&x| x < last);
        (width > 0).then_some(0).into_iter().chain(inner).chain((width > 1).then_some(last))
    }

    /// How many samples a line has at most.
    pub(crate) fn widest(&self) -> u32 {
        self.columns(0).count().max(self.columns(1).count()) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spacings_are_those_of_rpict() {
        for (spacing, across, down) in
            [(0, 1, 1), (1, 1, 1), (2, 3, 1), (4, 6, 3), (8, 11, 6), (16, 23, 11), (99, 23, 11)]
        {
            let lattice = Lattice::new(9, 9, spacing);
            assert_eq!((lattice.across, lattice.down), (across, down), "{spacing}");
        }
    }

    #[test]
    fn lines_alternate_and_end_at_the_borders() {
        let lattice = Lattice::new(15, 8, 4);
        assert_eq!(lattice.lines, [7, 4, 1, 0]);
        assert_eq!(lattice.columns(0).collect::<Vec<_>>(), [0, 6, 12, 14]);
        assert_eq!(lattice.columns(1).collect::<Vec<_>>(), [0, 3, 9, 14]);
        assert_eq!(lattice.widest(), 4);
        assert_eq!(Lattice::new(1, 1, 4).columns(0).collect::<Vec<_>>(), [0]);
        assert_eq!(Lattice::new(5, 1, 1).columns(1).collect::<Vec<_>>(), [0, 1, 2, 3, 4]);
        assert!(Lattice::new(0, 0, 4).lines.is_empty());
    }
}
