//! BSDF files: the XML schema of LBNL's WINDOW, as far as light needs it (function-files.md 15.1).
//!
//! The texts of elements are compared as they stand, blanks included; names of structures, units, directions,
//! wavelengths and bases regardless of case. What is not needed is skipped, as are wavelengths other than the visible
//! range and its CIE channels.

use super::basis::{BadBand, Basis, MOST_BANDS, MOST_BASES};
use ambit_base::Location;
use roxmltree::{Document, Node};
use std::borrow::Cow;
use std::fmt::Display;

/// What is wrong with a BSDF file and where, in Radiance's words where it has any.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{text}")]
pub(crate) struct ReadError {
    pub(crate) text: String,
    /// Line 0 if it is the whole file.
    pub(crate) location: Location,
}

/// How the numbers are arranged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Structure {
    /// A matrix, exiting patch by exiting patch.
    Columns,
    /// A matrix, incident patch by incident patch.
    Rows,
    /// An isotropic tensor tree.
    Tree3,
    /// A tensor tree of four dimensions.
    Tree4,
}

/// One of the four components, by the side it is lit from. Radiance's front, the side of the normal, is the file's back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    ReflectionFront,
    ReflectionBack,
    TransmissionFront,
    TransmissionBack,
}

/// Which quantity a block holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channel {
    Visible,
    X,
    Z,
    U,
    V,
}

/// The numbers of one component and channel.
#[derive(Debug)]
pub(super) struct Block<'t> {
    pub(super) component: Component,
    pub(super) channel: Channel,
    /// The element it comes from.
    node: Node<'t, 't>,
    pub(super) numbers: Cow<'t, str>,
}

/// A file that has been read.
#[derive(Debug)]
pub(super) struct Description<'t> {
    pub(super) structure: Structure,
    bases: Vec<Basis>,
    pub(super) blocks: Vec<Block<'t>>,
    place: Place<'t>,
}

/// Names of the file in errors, and where its lines are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<'t> {
    /// Name without its last suffix.
    pub(super) name: &'t str,
    pub(super) path: &'t str,
}

impl Place<'_> {
    fn error(&self, line: u32, column: u32, text: impl Display) -> ReadError {
        let location = Location { file: self.path.to_owned(), line, column };
        ReadError { text: text.to_string(), location }
    }

    /// An error at an element.
    fn at(&self, node: Node<'_, '_>, text: impl Display) -> ReadError {
        let p = node.document().text_pos_at(node.range().start);
        self.error(p.row, p.col, text)
    }

    /// Checks that a text is XML at all.
    pub(super) fn document<'x>(&self, text: &'x str) -> Result<Document<'x>, ReadError> {
        Document::parse(text).map_err(|e| {
            let (row, column) = match &e {
                // Told without a place: it is the end.
                roxmltree::Error::UnclosedRootNode | roxmltree::Error::UnexpectedEndOfStream => {
                    let last = text.lines().last().unwrap_or_default();
                    (text.lines().count().max(1) as u32, last.chars().count() as u32 + 1)
                }
                _ => (e.pos().row, e.pos().col),
            };
            let near = format!("File format error: BSDF \"{}\" [error near line {row}]: {e}", self.path);
            self.error(row, column, near)
        })
    }
}

fn child<'t>(node: Node<'t, 't>, name: &str) -> Option<Node<'t, 't>> {
    children(node, name).next()
}

fn children<'t>(node: Node<'t, 't>, name: &str) -> impl Iterator<Item = Node<'t, 't>> {
    node.children().filter(move |n| n.is_element() && n.tag_name().name() == name)
}

/// All text right inside an element, comments left out.
fn text<'t>(node: Node<'t, 't>) -> Cow<'t, str> {
    let mut parts = node.children().filter(Node::is_text).filter_map(|n| n.text());
    let first = parts.next().unwrap_or_default();
    match parts.next() {
        None => Cow::Borrowed(first),
        Some(second) => {
            let mut all = first.to_owned() + second;
            all.extend(parts);
            Cow::Owned(all)
        }
    }
}

fn text_of<'t>(node: Node<'t, 't>, name: &str) -> Cow<'t, str> {
    child(node, name).map_or(Cow::Borrowed(""), text)
}

fn one_of<T: Copy>(word: &str, table: &[(&str, T)]) -> Option<T> {
    table.iter().find(|(name, _)| name.eq_ignore_ascii_case(word)).map(|(_, value)| *value)
}

const STRUCTURES: [(&str, Structure); 4] = [
    ("Columns", Structure::Columns),
    ("Rows", Structure::Rows),
    ("TensorTree3", Structure::Tree3),
    ("TensorTree4", Structure::Tree4),
];
const COMPONENTS: [(&str, Component); 4] = [
    ("Transmission Front", Component::TransmissionBack),
    ("Transmission Back", Component::TransmissionFront),
    ("Reflection Front", Component::ReflectionBack),
    ("Reflection Back", Component::ReflectionFront),
];
const MATRIX_CHANNELS: [(&str, Channel); 3] =
    [("Visible", Channel::Visible), ("CIE-X", Channel::X), ("CIE-Z", Channel::Z)];
const TREE_CHANNELS: [(&str, Channel); 3] =
    [("Visible", Channel::Visible), ("CIE-u", Channel::U), ("CIE-v", Channel::V)];
const UNITS: [&str; 5] = ["Meter", "Foot", "Inch", "Centimeter", "Millimeter"];
const TREE_BASIS: &str = "LBNL/Shirley-Chiu";

impl<'t> Description<'t> {
    /// Reads what a document says.
    pub(super) fn read(document: &'t Document<'t>, place: Place<'t>) -> Result<Self, ReadError> {
        let root = document.root_element();
        let name = place.name;
        if root.tag_name().name() != "WindowElement" {
            let text = format!("File format error: BSDF \"{name}\": top level node not 'WindowElement'");
            return Err(place.at(root, text));
        }
        if let Some(node) = child(root, "FileType")
            && text(node) != "BSDF"
        {
            return Err(place.at(node, format!("File format error: XML \"{name}\": wrong FileType (must be 'BSDF')")));
        }
        let layer = child(root, "Optical").and_then(|n| child(n, "Layer"));
        let layer =
            layer.ok_or_else(|| place.at(root, format!("File format error: BSDF \"{name}\": no optical layers")))?;
        if let Some(material) = child(layer, "Material") {
            place.check_size(material)?;
        }
        place.check_geometry(layer)?;
        let definition = child(layer, "DataDefinition");
        let structure = definition.and_then(|n| child(n, "IncidentDataStructure")).ok_or_else(|| {
            place.at(layer, format!("File format error: BSDF \"{name}\": missing IncidentDataStructure"))
        })?;
        let arrangement = one_of(&text(structure), &STRUCTURES).ok_or_else(|| {
            let text = format!("Unsupported feature: BSDF \"{name}\": unsupported IncidentDataStructure");
            place.at(structure, text)
        })?;
        let mut bases = Basis::built_in();
        let is_tree = matches!(arrangement, Structure::Tree3 | Structure::Tree4);
        if let Some(definition) = definition
            && !is_tree
        {
            for node in children(definition, "AngleBasis") {
                place.add_basis(node, &mut bases)?;
            }
        }
        let channels = if is_tree { &TREE_CHANNELS } else { &MATRIX_CHANNELS };
        let mut blocks: Vec<Block<'t>> = Vec::new();
        for data in children(layer, "WavelengthData") {
            let Some(channel) = one_of(&text_of(data, "Wavelength"), channels) else { continue };
            for node in children(data, "WavelengthDataBlock") {
                let Some(component) = one_of(&text_of(node, "WavelengthDataDirection"), &COMPONENTS) else { continue };
                // A later block replaces an earlier one.
                blocks.retain(|b| (b.component, b.channel) != (component, channel));
                blocks.push(Block { component, channel, node, numbers: text_of(node, "ScatteringData") });
            }
        }
        Ok(Self { structure: arrangement, bases, blocks, place })
    }

    /// The block of a component and channel.
    pub(super) fn block(&self, component: Component, channel: Channel) -> Option<&Block<'t>> {
        self.blocks.iter().find(|b| (b.component, b.channel) == (component, channel))
    }

    /// The incident and the exiting basis of a matrix's block.
    pub(super) fn bases_of(&self, block: &Block<'t>) -> Result<[Basis; 2], ReadError> {
        let find = |element: &str, what: &str| {
            let name = &self.place.name;
            let node = child(block.node, element).ok_or_else(|| {
                let text = format!("File format error: Missing {what} basis for BSDF '{name}'");
                self.place.at(block.node, text)
            })?;
            let wanted = text(node);
            let known = self.bases.iter().find(|b| b.name.eq_ignore_ascii_case(&wanted));
            known
                .cloned()
                .ok_or_else(|| self.place.at(node, format!("File format error: Undefined {element} '{wanted}'")))
        };
        Ok([find("ColumnAngleBasis", "column")?, find("RowAngleBasis", "row")?])
    }

    /// Checks that a tree's block is over the basis that all trees have.
    pub(super) fn check_tree_basis(&self, block: &Block<'t>) -> Result<(), ReadError> {
        let basis = text_of(block.node, "AngleBasis");
        if basis.eq_ignore_ascii_case(TREE_BASIS) {
            return Ok(());
        }
        let name = &self.place.name;
        let text = format!("Unsupported feature: BSDF '{name}': AngleBasis must be '{TREE_BASIS}', not '{basis}'");
        Err(self.place.at(block.node, text))
    }

    /// An error in a block's numbers; `offset` bytes of them were good.
    pub(super) fn bad_data(&self, block: &Block<'t>, offset: usize, text: impl Display) -> ReadError {
        let error = self.place.at(child(block.node, "ScatteringData").unwrap_or(block.node), text);
        let lines = block.numbers.as_bytes().iter().take(offset).filter(|&&c| c == b'\n').count() as u32;
        let column = if lines == 0 { error.location.column } else { 0 };
        ReadError { location: Location { line: error.location.line + lines, column, ..error.location }, ..error }
    }

    /// The name that errors give the BSDF.
    pub(super) fn name(&self) -> &'t str {
        self.place.name
    }
}

impl Place<'_> {
    fn check_size(&self, material: Node<'_, '_>) -> Result<(), ReadError> {
        for name in ["Width", "Height", "Thickness"] {
            let Some(node) = material.children().find(|n| n.is_element() && n.tag_name().name() == name) else {
                continue;
            };
            let unit = node.attribute("unit").unwrap_or(UNITS[0]);
            if !UNITS.iter().any(|u| u.eq_ignore_ascii_case(unit)) {
                return Err(self.at(node, format!("Invalid data: Unknown dimensional unit '{unit}'")));
            }
            let size = node.text().and_then(|t| t.trim().parse::<f64>().ok());
            if size.is_some_and(|s| s < 0.0) {
                return Err(self.at(node, format!("Invalid data: Negative dimension in \"{}\"", self.name)));
            }
        }
        Ok(())
    }

    fn check_geometry(&self, layer: Node<'_, '_>) -> Result<(), ReadError> {
        let Some(node) = layer.children().find(|n| n.is_element() && n.tag_name().name() == "Geometry") else {
            return Ok(());
        };
        if let Some(format) = node.attribute("format")
            && !format.eq_ignore_ascii_case("MGF")
        {
            let text = format!("Unsupported feature: Unrecognized geometry format '{format}' in \"{}\"", self.name);
            return Err(self.at(node, text));
        }
        let block = node.children().find(|n| n.is_element() && n.tag_name().name() == "MGFblock");
        if let Some(block) = block
            && let Some(unit) = block.attribute("unit")
            && !UNITS.iter().any(|u| u.eq_ignore_ascii_case(unit))
        {
            return Err(self.at(block, format!("File format error: Unknown dimensional unit '{unit}'")));
        }
        Ok(())
    }

    /// Reads a basis, unless its name is known already.
    fn add_basis(&self, node: Node<'_, '_>, bases: &mut Vec<Basis>) -> Result<(), ReadError> {
        let part = |node: Node<'_, '_>, name: &str| {
            let found = node.children().find(|n| n.is_element() && n.tag_name().name() == name);
            found.and_then(|n| n.text().map(str::to_owned)).unwrap_or_default()
        };
        let name = part(node, "AngleBasisName");
        if name.is_empty() || bases.iter().any(|b| b.name.eq_ignore_ascii_case(&name)) {
            return Ok(());
        }
        if bases.len() >= MOST_BASES {
            return Err(self.at(node, format!("Invalid data: Too many angle bases ({MOST_BASES} at most) at '{name}'")));
        }
        let mut basis = Basis::named(&name);
        for band in node.children().filter(|n| n.is_element() && n.tag_name().name() == "AngleBasisBlock") {
            if basis.len() >= MOST_BANDS {
                return Err(self.at(band, format!("Invalid data: Too many bands ({MOST_BANDS} at most) in '{name}'")));
            }
            let bounds = band.children().find(|n| n.is_element() && n.tag_name().name() == "ThetaBounds");
            let angle =
                |which: &str| bounds.and_then(|b| part(b, which).trim().parse::<f64>().ok()).unwrap_or(f64::NAN);
            let count = part(band, "nPhis").trim().parse::<u32>().unwrap_or(0);
            basis.add(angle("LowerTheta"), angle("UpperTheta"), count).map_err(|e| {
                let what = match e {
                    BadBand::Count => "Illegal phi count",
                    BadBand::Theta => "Theta values disagree",
                };
                self.at(band, format!("Invalid data: {what} in '{name}'"))
            })?;
        }
        if basis.len() == 0 {
            return Err(self.at(node, format!("Invalid data: No bands in '{name}'")));
        }
        bases.push(basis);
        Ok(())
    }
}
