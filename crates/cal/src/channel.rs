//! The inputs of a program: what is known about the ray, the hit and the material, in function coordinates.

/// One input. The first 27 are Radiance's channels `$1` to `$27` in that order; the rest are variables that particular
/// materials provide.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Channel {
    /// x of the unit direction the ray travels.
    Dx,
    /// y of the ray direction.
    Dy,
    /// z of the ray direction.
    Dz,
    /// x of the unit surface normal.
    Nx,
    /// y of the normal.
    Ny,
    /// z of the normal.
    Nz,
    /// x of the hit point.
    Px,
    /// y of the hit point.
    Py,
    /// z of the hit point.
    Pz,
    /// Path length from the start of the primary ray.
    T,
    /// −D·N.
    Rdot,
    /// Local length of one world unit.
    S,
    /// x of the world origin in local coordinates.
    Tx,
    /// y of the world origin.
    Ty,
    /// z of the world origin.
    Tz,
    /// x of the world's x axis in local coordinates.
    Ix,
    /// y of the world's x axis.
    Iy,
    /// z of the world's x axis.
    Iz,
    /// x of the world's y axis.
    Jx,
    /// y of the world's y axis.
    Jy,
    /// z of the world's y axis.
    Jz,
    /// x of the world's z axis.
    Kx,
    /// y of the world's z axis.
    Ky,
    /// z of the world's z axis.
    Kz,
    /// Length of this ray (and of the shadow rays it continues).
    Ts,
    /// Mesh texture coordinate u.
    Lu,
    /// Mesh texture coordinate v.
    Lv,
    /// x of the perturbed normal, turned towards the viewer.
    NxP,
    /// y of the perturbed normal.
    NyP,
    /// z of the perturbed normal.
    NzP,
    /// −D·NP.
    RdotP,
    /// Red of the material's (or pattern's) colour.
    CrP,
    /// Green of the colour.
    CgP,
    /// Blue of the colour.
    CbP,
    /// x of the direction to the light sought (prisms).
    DxA,
    /// y of the direction to the light sought.
    DyA,
    /// z of the direction to the light sought.
    DzA,
}

/// How many inputs there are: the length of the array of values, indexed by `Channel as usize`.
pub const CHANNELS: usize = 37;

/// How many of them an expression may address as `$n`.
pub(crate) const NUMBERED: u32 = 27;

const NAMES: [&str; CHANNELS] = [
    "Dx", "Dy", "Dz", "Nx", "Ny", "Nz", "Px", "Py", "Pz", "T", "Rdot", "S", "Tx", "Ty", "Tz", "Ix", "Iy", "Iz", "Jx",
    "Jy", "Jz", "Kx", "Ky", "Kz", "Ts", "Lu", "Lv", "NxP", "NyP", "NzP", "RdotP", "CrP", "CgP", "CbP", "DxA", "DyA",
    "DzA",
];

/// First of the channels that Radiance sets in the context of the function file at work rather than globally.
const FIRST_LOCAL: usize = Channel::CrP as usize;

/// Names and indices of the channels that every context sees.
pub(crate) fn global_channels() -> impl Iterator<Item = (&'static str, u32)> {
    NAMES[..FIRST_LOCAL].iter().zip(0..).map(|(name, index)| (*name, index))
}

/// Index of a channel that a material sets in the context of its own file, by plain name.
pub(crate) fn local_channel(name: &str) -> Option<u32> {
    NAMES[FIRST_LOCAL..].iter().position(|known| *known == name).map(|k| (FIRST_LOCAL + k) as u32)
}

impl Channel {
    /// The variable's name in the language.
    pub fn name(self) -> &'static str {
        NAMES[self as usize]
    }
}

/// Which inputs a program may read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ChannelSet(u64);

impl ChannelSet {
    /// No input at all.
    pub const EMPTY: Self = Self(0);

    /// What only materials provide: the perturbed normal, its cosine, the colour and the light sought. A program of a
    /// pattern, texture or mixture that reads one of these reads, in Radiance, an undefined (or stale) variable.
    pub const MATERIAL: Self = Self(((1 << CHANNELS) - 1) & !((1 << Channel::NxP as u64) - 1));

    /// The set of these channels.
    pub fn of(channels: &[Channel]) -> Self {
        Self(channels.iter().fold(0, |bits, channel| bits | 1 << *channel as u64))
    }

    /// Whether `channel` is read.
    pub fn contains(self, channel: Channel) -> bool {
        self.0 & (1 << channel as u64) != 0
    }

    /// Whether any channel of `other` is read.
    pub fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Channels in either set.
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Channels of this set that are not in `other`.
    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// True if nothing is read.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The name of the first channel in the set, for messages.
    pub fn first_name(self) -> Option<&'static str> {
        NAMES.get(self.0.trailing_zeros() as usize).copied()
    }

    /// Adds the channel of this index; indices beyond the ray's (columns of a record) are not tracked.
    pub(crate) fn insert(&mut self, index: u32) {
        if (index as usize) < CHANNELS {
            self.0 |= 1 << index;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_at_their_indices() {
        assert_eq!(Channel::Dx.name(), "Dx");
        assert_eq!(Channel::Rdot as u32, 10, "$11");
        assert_eq!(Channel::Ts as u32, 24, "$25");
        assert_eq!(Channel::Lv as u32 + 1, NUMBERED);
        assert_eq!(Channel::RdotP.name(), "RdotP");
        assert_eq!(Channel::DzA.name(), "DzA");
        assert_eq!(Channel::DzA as usize + 1, CHANNELS);
        assert_eq!(local_channel("CrP"), Some(Channel::CrP as u32));
        assert_eq!(local_channel("NxP"), None);
    }

    #[test]
    fn sets_hold_what_was_put_in() {
        let set = ChannelSet::of(&[Channel::Px, Channel::DzA]);
        assert!(set.contains(Channel::Px) && set.contains(Channel::DzA) && !set.contains(Channel::Py));
        assert!(set.intersects(ChannelSet::MATERIAL));
        assert_eq!(set.without(ChannelSet::MATERIAL), ChannelSet::of(&[Channel::Px]));
        assert_eq!(ChannelSet::of(&[Channel::CrP]).first_name(), Some("CrP"));
        assert_eq!(ChannelSet::EMPTY.first_name(), None);
    }
}
