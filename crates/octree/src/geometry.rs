//! What the build needs to know of each object: four bytes, which lead to the coordinates in the scene's own arrays for
//! polygons and to a small table for everything else.

use crate::Cube;
use crate::overlap::{ConeFamily, Octants, PolygonTest, Relation, Volume, sphere_meets};
use ambit_base::DVec3;
use ambit_scene::{Bounds, Facet, ObjectId, Scene, Shape};

/// The geometry of a run of objects of a scene, ready to be tested against cubes.
#[derive(Debug)]
pub struct Geometry {
    first: ObjectId,
    entries: Vec<Entry>,
    others: Vec<Other>,
    bounds: Option<Bounds>,
    has_volumes: bool,
}

/// Kind of an object, or index into the table of other shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Entry(u32);

impl Entry {
    /// In no cube.
    const NOWHERE: Self = Self(u32::MAX);
    /// A polygon with its vertices as they stand in the scene.
    const POLYGON: Self = Self(u32::MAX - 1);
    /// A polygon whose last vertex repeats the first.
    const CLOSED_POLYGON: Self = Self(u32::MAX - 2);

    /// The object as a polygon, if it is one.
    #[inline]
    fn polygon(self, scene: &Scene, id: ObjectId) -> Option<PolygonTest<'_>> {
        let numbers = scene.reals(id);
        match self {
            Self::POLYGON => Some(PolygonTest::new(numbers)),
            // The last vertex is the repeated one.
            Self::CLOSED_POLYGON => Some(PolygonTest::new(&numbers[..numbers.len().saturating_sub(3)])),
            _ => None,
        }
    }
}

#[derive(Clone, Debug)]
enum Other {
    Sphere { centre: DVec3, radius: f64 },
    Cone(ConeFamily),
    Volume(Box<Volume>),
}

impl Geometry {
    /// Starts with object `first`; the rest is added in order.
    pub fn starting_at(first: ObjectId) -> Self {
        Self { first, entries: Vec::new(), others: Vec::new(), bounds: None, has_volumes: false }
    }

    /// The next object is no surface, or has no place in space.
    pub fn push_nothing(&mut self) {
        self.entries.push(Entry::NOWHERE);
    }

    /// The next object is a polygon of the scene.
    pub fn push_polygon(&mut self, facet: &Facet<'_>, numbers: usize) {
        // A polygon without area can not be hit, but the cube still encloses it.
        self.grow(Some(facet.bounds()));
        self.entries.push(if facet.is_degenerate() {
            Entry::NOWHERE
        } else if facet.vertex_count() * 3 == numbers {
            Entry::POLYGON
        } else {
            Entry::CLOSED_POLYGON
        });
    }

    /// The next object is a surface of the scene.
    pub fn push_shape(&mut self, scene: &Scene, shape: &Shape) {
        let id = self.first + self.entries.len() as ObjectId;
        self.grow(scene.surface_bounds(id, shape));
        let entry = match shape {
            Shape::Polygon(p) if p.vertices.len() * 3 == scene.reals(id).len() => Entry::POLYGON,
            Shape::Polygon(_) => Entry::CLOSED_POLYGON,
            Shape::Sphere(s) => self.add(Other::Sphere { centre: s.centre, radius: s.radius }),
            Shape::Cone(c) => {
                self.add(Other::Cone(ConeFamily { p0: c.p0, p1: c.p1, r0: c.r0, r1: c.r1, axis: c.axis }))
            }
            Shape::Ring(r) => {
                self.add(Other::Cone(ConeFamily { p0: r.centre, p1: r.centre, r0: r.r0, r1: r.r1, axis: r.normal }))
            }
            Shape::Source(_) | Shape::Degenerate => Entry::NOWHERE,
        };
        self.entries.push(entry);
    }

    /// The next object is an instance or a mesh.
    pub fn push_volume(&mut self, volume: Volume) {
        self.grow(Some(volume.bounds()));
        let entry = self.add(Other::Volume(Box::new(volume)));
        self.entries.push(entry);
        self.has_volumes = true;
    }

    fn add(&mut self, other: Other) -> Entry {
        self.others.push(other);
        Entry(self.others.len() as u32 - 1)
    }

    fn grow(&mut self, b: Option<Bounds>) {
        self.bounds = match (self.bounds, b) {
            (Some(mut a), Some(b)) => {
                a.join(&b);
                Some(a)
            }
            (a, b) => a.or(b),
        };
    }

    /// Number of the first object.
    pub fn first(&self) -> ObjectId {
        self.first
    }

    /// The box around all objects.
    pub fn bounds(&self) -> Option<Bounds> {
        self.bounds
    }

    /// Whether an instance or mesh is among the objects.
    pub fn has_volumes(&self) -> bool {
        self.has_volumes
    }

    /// Numbers of the objects that can be in a cube, in order.
    pub fn placed(&self) -> impl Iterator<Item = ObjectId> {
        let first = self.first;
        self.entries.iter().enumerate().filter(|(_, e)| **e != Entry::NOWHERE).map(move |(i, _)| first + i as ObjectId)
    }

    fn entry(&self, id: ObjectId) -> Entry {
        let at = id.checked_sub(self.first).and_then(|i| self.entries.get(i as usize));
        at.copied().unwrap_or(Entry::NOWHERE)
    }

    /// True for an instance or a mesh.
    pub fn is_volume(&self, id: ObjectId) -> bool {
        let at = self.others.get(self.entry(id).0 as usize);
        matches!(at, Some(Other::Volume(_)))
    }

    /// How an object of `scene` lies in relation to a cube. Parts below `smallest` in size are not told apart.
    pub(crate) fn relation(&self, scene: &Scene, id: ObjectId, cube: &Cube, smallest: f64) -> Relation {
        let entry = self.entry(id);
        if entry == Entry::NOWHERE {
            return Relation::Miss;
        }
        match entry.polygon(scene, id) {
            Some(polygon) => polygon.meets(cube).into(),
            None => self.others[entry.0 as usize].relation(cube, smallest),
        }
    }

    /// Which children of a cube an object is in, one bit each; for a volume, all that are to be looked at one by one.
    #[inline]
    pub(crate) fn children(&self, scene: &Scene, id: ObjectId, cube: &Cube, octants: &Octants, smallest: f64) -> u8 {
        let entry = self.entry(id);
        if entry == Entry::NOWHERE {
            return 0;
        }
        if let Some(polygon) = entry.polygon(scene, id) {
            return polygon.children(cube, octants);
        }
        let other = &self.others[entry.0 as usize];
        if matches!(other, Other::Volume(_)) {
            return 0xff;
        }
        (0..8).filter(|&c| other.relation(&cube.child(c), smallest) != Relation::Miss).fold(0, |m, c| m | 1 << c)
    }
}

impl Other {
    fn relation(&self, cube: &Cube, smallest: f64) -> Relation {
        match self {
            Self::Sphere { centre, radius } => sphere_meets(*centre, *radius, cube.origin, cube.edge).into(),
            Self::Cone(c) => c.meets(cube.origin, cube.edge, smallest).into(),
            Self::Volume(v) => v.relation(cube),
        }
    }
}
