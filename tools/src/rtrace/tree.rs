//! Ray trees: a line for every ray, indented by its depth.

use super::record::RecordWriter;
use crate::spectral::Converter;
use ambit_cli::{RayOptions, TreeSpec};
use ambit_file::bytes_of;
use ambit_render::{Bins, Names, Selection, TreeRay};

/// Writes the rays of trees.
pub(crate) struct TreeWriter<'a> {
    record: RecordWriter<'a>,
    shadows: bool,
    selection: &'a Selection,
}

impl<'a> TreeWriter<'a> {
    /// Writes what `spec` asks for of the rays that the options select.
    pub(crate) fn new(spec: &'a TreeSpec, conversion: &'a Converter, options: &'a RayOptions) -> Self {
        let record = RecordWriter::new(&spec.fields, conversion, options);
        Self { record, shadows: spec.shadows, selection: &options.tree }
    }

    /// Appends a ray's line, if it is to have one.
    pub(crate) fn write(&self, out: &mut Vec<u8>, ray: &TreeRay, bins: Option<Bins<'_>>, names: Names<'_>) {
        if ray.clear_shadow && !self.shadows || !self.selects(ray, names) {
            return;
        }
        out.resize(out.len() + ray.depth, b'\t');
        self.record.write_bins(out, &ray.answer, ray.contribution, bins, names);
    }

    /// True if what the ray hits has one of the wanted modifiers.
    fn selects(&self, ray: &TreeRay, names: Names<'_>) -> bool {
        let listed = |list: &[String]| {
            ray.answer.surface != ambit_scene::VOID
                && list.iter().any(|name| *bytes_of(name) == *names(ray.answer.modifier, ray.answer.modifier))
        };
        match self.selection {
            Selection::All => true,
            Selection::Include(list) => listed(list),
            Selection::Exclude(list) => !listed(list),
        }
    }
}
