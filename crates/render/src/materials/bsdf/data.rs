//! A BSDF file as shading sees it: for each side two components, each a Lambertian part and perhaps a lobe.

use super::klems::Table;
use super::lobe::Lobe;
use super::numbers::Numbers;
use super::tree_lobe::{TreeLobe, Trees};
use super::tree_text;
use super::xml::{Block, Channel, Component, Description, Place, ReadError, Structure};
use ambit_base::{Notify, Rgb};

/// Totals beyond this get a warning.
const IMPLAUSIBLE: f64 = 1.01;

/// One component seen from one side.
#[derive(Debug, Default)]
pub(super) struct Scattering {
    /// Lambertian reflectance or transmittance.
    pub(super) diffuse: Rgb,
    /// What is not Lambertian, less the Lambertian part.
    pub(super) lobe: Option<Lobe>,
}

/// Reflection and transmission, each seen from the front (+z) and from the back.
#[derive(Debug, Default)]
pub(crate) struct Distribution {
    pub(super) reflection: [Scattering; 2],
    pub(super) transmission: [Scattering; 2],
}

impl Distribution {
    /// Reads a file's text. `path` is what errors call it; scattering of more light than there is gets a warning.
    pub(crate) fn read(bytes: &[u8], path: &str, notify: &dyn Notify) -> Result<Self, ReadError> {
        let file = path.rsplit('/').next().unwrap_or(path);
        let name = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
        let place = Place { name, path };
        // Names in other encodings than UTF-8 do no harm: nothing that counts is outside ASCII.
        let text = String::from_utf8_lossy(bytes);
        let document = place.document(&text)?;
        let description = Description::read(&document, place)?;
        let warn = |what: &str, most: f64| {
            if most > IMPLAUSIBLE {
                notify.warn(&format!("BSDF \"{name}\" has {:.1}% {what}", 100.0 * most));
            }
        };
        let mut all = Self::default();
        if matches!(description.structure, Structure::Columns | Structure::Rows) {
            all.fill(
                |component| table(&description, component),
                |table, exchanged| {
                    let (table, turn) = if exchanged { (table.exchanged(), -1.0) } else { (table.clone(), 1.0) };
                    let (diffuse, lobe, most) = table.split(turn);
                    (Scattering { diffuse, lobe: lobe.map(Lobe::Matrix) }, most)
                },
                warn,
            )?;
        } else {
            all.fill(
                |component| Ok(trees(&description, component)?.map(Trees::split)),
                |(diffuse, rest), exchanged| {
                    let (lobe, most) = TreeLobe::new(rest, exchanged);
                    (Scattering { diffuse: *diffuse, lobe: lobe.map(Lobe::Tree) }, most)
                },
                warn,
            )?;
        }
        Ok(all)
    }

    /// Fills the components from what `read` gives; what is missing of one side's transmission is the
    /// other's exchanged.
    fn fill<T>(
        &mut self,
        read: impl Fn(Component) -> Result<Option<T>, ReadError>,
        make: impl Fn(&T, bool) -> (Scattering, f64),
        warn: impl Fn(&str, f64),
    ) -> Result<(), ReadError> {
        let make = |data: &T, exchanged: bool, what: &str| {
            let (scattering, most) = make(data, exchanged);
            if !exchanged {
                warn(what, most);
            }
            scattering
        };
        if let Some(data) = read(Component::ReflectionFront)? {
            self.reflection[0] = make(&data, false, "front reflection");
        }
        if let Some(data) = read(Component::ReflectionBack)? {
            self.reflection[1] = make(&data, false, "rear reflection");
        }
        let (front, back) = (read(Component::TransmissionFront)?, read(Component::TransmissionBack)?);
        if let Some(data) = &front {
            self.transmission[0] = make(data, false, "front transmission");
        }
        if let Some(data) = &back {
            self.transmission[1] = make(data, false, "back transmission");
        }
        // A side without data is the other one by reciprocity; so is the lobe of a side that has none worth keeping.
        for (side, own, other) in [(0, &front, &back), (1, &back, &front)] {
            let scattering = &mut self.transmission[side];
            if let Some(data) = other
                && scattering.lobe.is_none()
            {
                let exchanged = make(data, true, "");
                scattering.lobe = exchanged.lobe;
                if own.is_none() {
                    scattering.diffuse = exchanged.diffuse;
                }
            }
        }
        Ok(())
    }
}

fn table(description: &Description<'_>, component: Component) -> Result<Option<Table>, ReadError> {
    let Some(block) = description.block(component, Channel::Visible) else { return Ok(None) };
    let visible = matrix(description, block)?;
    let chroma = match [Channel::X, Channel::Z].map(|c| description.block(component, c)) {
        [Some(x), Some(z)] => {
            let (x, z) = (matrix(description, x)?, matrix(description, z)?);
            // Channels over different bases have no colour in common.
            let same = |t: &Table| t.incoming == visible.incoming && t.outgoing == visible.outgoing;
            (same(&x) && same(&z)).then_some([x.visible, z.visible])
        }
        _ => None,
    };
    Ok(Some(Table { chroma, ..visible }))
}

/// One channel's numbers in the order of incident, then exiting patches.
fn matrix(description: &Description<'_>, block: &Block<'_>) -> Result<Table, ReadError> {
    let [incoming, outgoing] = description.bases_of(block)?;
    let (n, m) = (incoming.patches(), outgoing.patches());
    let mut numbers = Numbers::new(&block.numbers);
    let mut all = Vec::new();
    while all.len() < n * m {
        let Some(v) = numbers.next_number() else {
            let text = format!("File format error: Bad/missing BSDF ScatteringData in '{}'", description.name());
            return Err(description.bad_data(block, numbers.offset(), text));
        };
        all.push(v);
    }
    if description.structure == Structure::Columns {
        all = (0..n * m).map(|k| all[(k % m) * n + k / m]).collect();
    }
    Ok(Table { incoming, outgoing, visible: all, chroma: None })
}

fn trees(description: &Description<'_>, component: Component) -> Result<Option<Trees>, ReadError> {
    let rank = if description.structure == Structure::Tree3 { 3 } else { 4 };
    let tree = |block: &Block<'_>| {
        description.check_tree_basis(block)?;
        if Numbers::new(&block.numbers).peek().is_none() {
            let text = format!("File format error: Bad/missing BSDF ScatteringData in '{}'", description.name());
            return Err(description.bad_data(block, 0, text));
        }
        tree_text::parse(&block.numbers, rank).map_err(|(problem, offset)| {
            let text = format!("File format error: {problem} in '{}'", description.name());
            description.bad_data(block, offset, text)
        })
    };
    let Some(block) = description.block(component, Channel::Visible) else { return Ok(None) };
    let visible = tree(block)?;
    let chroma = match [Channel::U, Channel::V].map(|c| description.block(component, c)) {
        [Some(u), Some(v)] => Some([tree(u)?, tree(v)?]),
        _ => None,
    };
    Ok(Some(Trees { visible, chroma }))
}
