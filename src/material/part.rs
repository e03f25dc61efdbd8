use super::Material;
use crate::spectrum::Quantity;

/// A material that another one is made of: its name in the scene file, and what stands there under that name.
#[derive(Clone, Debug)]
pub struct Part<S> {
    /// The name.
    pub name: String,
    material: Box<Material<S>>,
}

impl<S> Part<S> {
    /// The material that a name stands for.
    pub fn new(name: &str, material: Material<S>) -> Self {
        Self { name: name.to_owned(), material: Box::new(material) }
    }

    /// The material.
    pub fn material(&self) -> &Material<S> {
        &self.material
    }

    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Part<T> {
        Part::new(&self.name, self.material.map(convert))
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
