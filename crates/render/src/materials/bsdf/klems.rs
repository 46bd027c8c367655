//! Matrices over two angle bases: values constant on pairs of an incident and an exiting patch.

use super::basis::Basis;
use super::colour::{Cie, Coloured};
use super::lobe::{Cell, DROPPED, is_diffuse};
use ambit_base::{DVec3, Rgb};
use std::f64::consts::PI;

/// A matrix less its Lambertian part.
#[derive(Debug)]
pub(super) struct Matrix {
    incoming: Basis,
    outgoing: Basis,
    /// +1; −1 if the roles of the two directions are exchanged, which turns both bases about the pole.
    turn: f64,
    /// Photometric values in 1/sr by incident, then exiting patch.
    values: Vec<f32>,
    /// Their colours, if not grey.
    colours: Option<Vec<Rgb>>,
    /// For each incident patch, sums of value × projected solid angle up to and including each exiting patch.
    cumulative: Vec<f32>,
}

/// One component's numbers as the file has them, by incident and then exiting patch.
#[derive(Clone, Debug)]
pub(super) struct Table {
    pub(super) incoming: Basis,
    pub(super) outgoing: Basis,
    /// Y.
    pub(super) visible: Vec<f32>,
    /// X and Z.
    pub(super) chroma: Option<[Vec<f32>; 2]>,
}

impl Table {
    /// The same scattering with the roles of the directions exchanged (Helmholtz reciprocity); addresses are turned.
    pub(super) fn exchanged(&self) -> Self {
        let (n, m) = (self.incoming.patches(), self.outgoing.patches());
        let turned = |v: &[f32]| (0..m * n).map(|k| v[(k % n) * m + k / n]).collect::<Vec<f32>>();
        Self {
            incoming: self.outgoing.clone(),
            outgoing: self.incoming.clone(),
            visible: turned(&self.visible),
            chroma: self.chroma.as_ref().map(|[x, z]| [turned(x), turned(z)]),
        }
    }

    /// Splits off the Lambertian part, and gives the rest if there is enough of it; `turn` is −1 for an exchanged table.
    /// Also gives the largest total of both parts.
    pub(super) fn split(self, turn: f64) -> (Rgb, Option<Matrix>, f64) {
        let least = |v: &[f32]| v.iter().copied().fold(f32::INFINITY, f32::min);
        let mut y = least(&self.visible);
        let mut xyz = Cie { x: y, y, z: y };
        if let Some([x, z]) = &self.chroma {
            xyz = Cie { x: least(x), y, z: least(z) };
        }
        if !is_diffuse(f64::from(y)) {
            (y, xyz) = (0.0, Cie::default());
        }
        let base = if self.chroma.is_some() { xyz.rgb() } else { Rgb::splat(y) };
        let colours = self.chroma.as_ref().map(|[x, z]| {
            let all = self.visible.iter().zip(x).zip(z);
            all.map(|((&y, &x), &z)| (Cie { x, y, z }.rgb() - base).max(Rgb::ZERO)).collect()
        });
        let mut values = self.visible;
        for v in &mut values {
            *v -= y;
        }
        let mut matrix =
            Matrix { incoming: self.incoming, outgoing: self.outgoing, turn, values, colours, cumulative: Vec::new() };
        let most = matrix.accumulate();
        let diffuse = base * std::f32::consts::PI;
        (diffuse, (most > DROPPED).then_some(matrix), most + PI * f64::from(y))
    }
}

impl Matrix {
    /// Fills the sums; the largest total.
    fn accumulate(&mut self) -> f64 {
        let m = self.outgoing.patches();
        let areas: Vec<f64> = (0..m).map(|o| self.outgoing.area(o)).collect();
        let mut most = 0.0f64;
        self.cumulative = Vec::with_capacity(self.values.len());
        for row in self.values.chunks_exact(m) {
            let mut sum = 0.0;
            for (v, area) in row.iter().zip(&areas) {
                sum += f64::from(*v) * area;
                self.cumulative.push(sum as f32);
            }
            most = most.max(sum);
        }
        most
    }

    fn incoming(&self, v: DVec3) -> Option<usize> {
        self.incoming.patch(-self.turn * v.x, -self.turn * v.y, v.z)
    }

    fn outgoing(&self, v: DVec3) -> Option<usize> {
        self.outgoing.patch(self.turn * v.x, self.turn * v.y, v.z)
    }

    pub(super) fn cell(&self, incident: DVec3, exiting: DVec3) -> Option<Cell> {
        let (i, o) = (self.incoming(incident)?, self.outgoing(exiting)?);
        let index = i * self.outgoing.patches() + o;
        Some(Cell {
            index,
            value: self.values[index],
            area: self.outgoing.area(o),
            incident_area: self.incoming.area(i),
        })
    }

    pub(super) fn colour(&self, cell: &Cell) -> Coloured {
        match &self.colours {
            None => Coloured::Grey(cell.value),
            Some(all) => Coloured::Rgb(all[cell.index]),
        }
    }

    pub(super) fn least_area(&self) -> f64 {
        self.incoming.least_area().min(self.outgoing.least_area())
    }

    pub(super) fn total(&self, incident: DVec3) -> f64 {
        self.row(incident).and_then(|row| row.last()).map_or(0.0, |&t| f64::from(t))
    }

    fn row(&self, incident: DVec3) -> Option<&[f32]> {
        let m = self.outgoing.patches();
        self.incoming(incident).map(|i| &self.cumulative[i * m..(i + 1) * m])
    }

    pub(super) fn sample(&self, incident: DVec3, x: [f64; 2]) -> Option<DVec3> {
        let d = self.outgoing.sample(self.row(incident)?, x)?;
        Some(DVec3::new(self.turn * d.x, self.turn * d.y, d.z))
    }
}
