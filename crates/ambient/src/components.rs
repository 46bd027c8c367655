//! The components of a value in an ambient file, and where they stand in records: in red, green and blue, which take turns
//! at them in the passes of a calculation by wavelength.

use crate::conversion::Conversion;
use crate::record::Record;
use ambit_base::Rgb;

/// Where each component of a file's values stands, and which one each channel of each pass holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Components {
    /// Pass and channel of each component.
    places: Vec<(u8, u8)>,
    /// Components of the three channels in each pass. Channels may share one, and pass over others.
    passes: Vec<[u8; 3]>,
    /// If the file has others than these.
    conversion: Option<Conversion>,
}

impl Default for Components {
    /// Red, green and blue.
    fn default() -> Self {
        Self::in_order(3)
    }
}

impl Components {
    /// Fewest that files have.
    pub const FEWEST: usize = 3;
    /// Most that files have.
    pub const MOST: usize = 24;

    /// Components of which each has its place in a pass and channel, and each channel of each pass its component.
    /// None if numbers are out of range.
    pub fn new(places: Vec<(u8, u8)>, passes: Vec<[u8; 3]>) -> Option<Self> {
        let count = places.len();
        let known = places.iter().all(|&(pass, channel)| usize::from(pass) < passes.len() && channel < 3)
            && passes.iter().flatten().all(|&c| usize::from(c) < count);
        ((Self::FEWEST..=Self::MOST).contains(&count) && known).then_some(Self { places, passes, conversion: None })
    }

    /// So many components, three to twenty-four, in the order in which they come: what those do who only look at files.
    pub fn in_order(count: usize) -> Self {
        let count = count.clamp(Self::FEWEST, Self::MOST) as u8;
        let places = (0..count).map(|k| (k / 3, k % 3)).collect();
        let passes = (0..count.div_ceil(3)).map(|pass| [0, 1, 2].map(|c| (3 * pass + c).min(count - 1))).collect();
        Self { places, passes, conversion: None }
    }

    /// These, in a file that has others.
    pub(crate) fn converted(&self, conversion: Conversion) -> Self {
        Self { conversion: Some(conversion), ..self.clone() }
    }

    /// True if what is read and written is converted, and not the same afterwards.
    pub(crate) fn is_converted(&self) -> bool {
        self.conversion.is_some()
    }

    /// How many there are in a file.
    pub fn count(&self) -> usize {
        self.conversion.as_ref().map_or(self.places.len(), Conversion::count)
    }

    /// The components of a record's value.
    pub fn of(&self, record: &Record) -> impl Iterator<Item = f32> + use<> {
        let mut values = [0.0; Self::MOST];
        for (value, &(pass, channel)) in values.iter_mut().zip(&self.places) {
            *value = record.of_pass(pass)[usize::from(channel)];
        }
        if let Some(conversion) = &self.conversion {
            values = conversion.write(&values[..self.places.len()]);
        }
        values.into_iter().take(self.count())
    }

    /// Sets the value of a record, in every pass.
    pub(crate) fn give(&self, components: &[f32], record: &mut Record) {
        let converted = self.conversion.as_ref().map(|conversion| conversion.read(components));
        let components = converted.as_ref().map_or(components, |values| values.as_slice());
        let colour = |pass: &[u8; 3]| Rgb::from_array(pass.map(|c| components[usize::from(c)]));
        let (first, further) = self.passes.split_first().expect("there is a pass: components have their places in one");
        record.value = colour(first);
        record.further = further.iter().map(colour).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_out_of_range_are_none() {
        assert!(
            Components::new(vec![(0, 0), (0, 1), (0, 2)], vec![[0, 1, 2]]).is_some_and(|c| c == Components::default())
        );
        assert!(Components::new(vec![(0, 0), (0, 1), (1, 2)], vec![[0, 1, 2]]).is_none());
        assert!(Components::new(vec![(0, 0), (0, 1), (0, 2)], vec![[0, 1, 3]]).is_none());
        assert!(Components::new(vec![(0, 0), (0, 1)], vec![[0, 1, 1]]).is_none());
    }
}
