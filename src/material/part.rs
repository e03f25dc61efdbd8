use serde::Deserialize;

use super::{Mask, Material, Mix};
use crate::spectrum::Quantity;

/// A material that another one is made of: its name in the scene file, and what stands there under that name.
#[derive(Clone, Debug, Deserialize)]
#[serde(from = "String")]
pub struct Part<S> {
    /// The name.
    pub name: String,
    found: Option<Box<Material<S>>>,
}

impl<S> From<String> for Part<S> {
    fn from(name: String) -> Self {
        Self { name, found: None }
    }
}

impl<S> Part<S> {
    /// The part with the material that its name stands for.
    pub fn found(&self, material: Material<S>) -> Self {
        Self { name: self.name.clone(), found: Some(Box::new(material)) }
    }

    /// The material of a part in a compiled scene.
    ///
    /// # Panics
    /// Before the scene is compiled.
    pub fn material(&self) -> &Material<S> {
        self.found.as_deref().expect("compiling a scene finds the material of every name")
    }

    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Part<T> {
        let found = self.found.as_ref().map(|material| Box::new(material.map(convert)));
        Part { name: self.name.clone(), found }
    }
}

impl<S> Material<S> {
    /// The materials it is made of.
    pub fn parts(&self) -> &[Part<S>] {
        match self {
            Self::Mix(mix) => &mix.materials,
            Self::Mask(mask) => std::slice::from_ref(&mask.material),
            Self::Diffuse(_) | Self::Mirror(_) | Self::Conductor(_) | Self::Dielectric(_) => &[],
            Self::Thin(_) | Self::Emissive(_) | Self::Plastic(_) => &[],
        }
    }

    /// The same material with its parts found; `find` is told the place of each.
    pub fn with_found<E>(&self, mut find: impl FnMut(usize, &Part<S>) -> Result<Part<S>, E>) -> Result<Self, E>
    where
        S: Clone,
    {
        Ok(match self {
            Self::Mix(Mix { materials: [first, second], amount }) => {
                let materials = [find(0, first)?, find(1, second)?];
                Self::Mix(Mix { materials, amount: amount.clone() })
            }
            Self::Mask(Mask { material, opacity }) => {
                Self::Mask(Mask { material: find(0, material)?, opacity: opacity.clone() })
            }
            whole => whole.clone(),
        })
    }

    /// The material and all that it is made of.
    pub fn with_parts(&self) -> Vec<&Self> {
        let parts = self.parts().iter().flat_map(|part| part.material().with_parts());
        std::iter::once(self).chain(parts).collect()
    }

    /// Whether it is made of the material of a name.
    pub fn is_made_of(&self, name: &str) -> bool {
        self.parts().iter().any(|part| part.name == name || part.material().is_made_of(name))
    }
}
