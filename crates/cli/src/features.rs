//! `-features`: what a program can do, for scripts that ask before they use it. Only what is served is listed.

/// The features of a program, a line each; `NAME=a,b` has a list.
#[derive(Clone, Copy, Debug)]
pub struct Features(pub &'static [&'static [&'static str]]);

/// What all rendering programs can do.
pub const COMMON_FEATURES: &[&str] = &[
    "VirtualSources",
    "SecondarySources",
    "SourceSubsampling",
    "SourceVisibility",
    "AmbientModifierSelection",
    "PathTracing",
    "RussianRoulette",
    "LowDiscrepancySeq",
    "SpecularSampling",
    "MaterialMixtures",
    "Antimatter",
    "BackFaceVisibility",
    "ScatteringModels=WGMD,Ashikhmin-Shirley",
    "TabulatedBSDFs=DataFile,KlemsXML,TensorTreeXML,+ViewPeakExtraction",
    "Instancing=Octree,TriangleMesh",
    "Aliases",
    "Hyperspectral",
    "ShadowCache",
    "ParticipatingMedia=Mist",
];

/// What `rpict` can do besides.
pub const PICTURE_FEATURES: &[&str] = &[
    "Multiprocessing",
    "Recovery",
    "IrradianceCalc",
    "ViewTypes=v,l,a,h,s,c",
    "HessianAmbientCache",
    "AmbientAveraging",
    "AmbientValueSharing",
    "PixelJitter",
    "PixelSampling",
    "PixelMotion",
    "PixelDepthOfField",
    "SmallSourceDrawing",
    "ViewSequence",
    "ProgressReporting",
    "AdaptiveShadowTesting",
    "Outputs=v,l",
    "OutputCS=RGB,XYZ,prims",
];

/// What `rtrace` can do besides.
pub const RAY_FEATURES: &[&str] = &[
    "Multiprocessing",
    "IrradianceCalc",
    "ImmediateIrradiance",
    "DistanceLimiting",
    "HessianAmbientCache",
    "AmbientAveraging",
    "AmbientValueSharing",
    "AdaptiveShadowTesting",
    "InputFormats=a,f,d",
    "OutputFormats=a,f,d,c",
    "Outputs=o,d,v,V,w,W,l,L,c,p,n,N,s,m,M,r,x,R,X,~",
    "OutputCS=RGB,XYZ,Y,S,M,prims,spec",
];

impl Features {
    fn lines(self) -> impl Iterator<Item = &'static str> {
        self.0.iter().copied().flatten().copied()
    }

    /// The list; or, if features are asked for, the lists of those that were asked for by a name without `=`.
    ///
    /// A name may be the beginning of a feature's. Returns what is to be printed and, if a feature is missing, the
    /// complaint that follows it: `missing feature - NAME`.
    pub fn answer(self, wanted: &[String]) -> (String, Option<String>) {
        let mut text = String::new();
        if wanted.is_empty() {
            for line in self.lines() {
                text.push_str(line);
                text.push('\n');
            }
            return (text, None);
        }
        for name in wanted {
            match self.find(name) {
                None => return (text, Some(format!("missing feature - {name}"))),
                Some(line) if line.contains('=') && !name.contains('=') => {
                    text.push_str(line);
                    text.push('\n');
                }
                Some(_) => {}
            }
        }
        (text, None)
    }

    fn find(self, wanted: &str) -> Option<&'static str> {
        let Some((name, items)) = wanted.split_once('=') else {
            return self.lines().find(|line| !wanted.is_empty() && line.starts_with(wanted));
        };
        self.lines().find(|line| {
            line.split_once('=')
                .is_some_and(|(n, list)| n == name && items.split(',').all(|item| list.split(',').any(|i| i == item)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn questions_are_answered_as_rtrace_does() {
        let features = Features(&[COMMON_FEATURES, RAY_FEATURES]);
        for (wanted, text, missing) in [
            ("Outp", "OutputFormats=a,f,d,c\n", None),
            ("Aliases", "", None),
            ("Hyperspectral", "", None),
            ("OutputCS=spec", "", None),
            ("V", "", None),
            ("Outputs=v,l", "", None),
            ("Outputs=v,q", "", Some("missing feature - Outputs=v,q")),
            ("Nope", "", Some("missing feature - Nope")),
        ] {
            let (printed, absent) = features.answer(&[wanted.to_owned()]);
            assert_eq!((printed.as_str(), absent.as_deref()), (text, missing), "{wanted}");
        }
        assert!(features.answer(&[]).0.starts_with("VirtualSources\n"));
    }
}
