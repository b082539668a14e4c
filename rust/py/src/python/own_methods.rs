//! Methods whose work native code does, and whether a program replaced one.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use pyo3::prelude::*;
use pyo3::types::{PyString, PyType};

use crate::python::instance_dict::generic_setattr;

/// Of one object: whether its methods `names` are mavwire's own. Then native code need not call them.
pub(crate) struct OwnMethods {
    names: &'static [&'static str],
    intact: AtomicBool,
}

impl OwnMethods {
    /// Those of an object without native code.
    pub(crate) const fn none() -> Self {
        Self { names: &[], intact: AtomicBool::new(false) }
    }

    /// Those of a new object of `class`. `_quick_methods` of the class lists each method with the class that has it (None
    /// for `class` itself) and its original, since a program may replace a method in a subclass or in mavwire's class.
    pub(crate) fn of_class(
        names: &'static [&'static str],
        class: &Bound<'_, PyType>,
    ) -> PyResult<Self> {
        let intact = AtomicBool::new(true);
        for method in class.getattr(intern!(class.py(), "_quick_methods"))?.try_iter()? {
            let (owner, name, original): (
                Option<Bound<'_, PyAny>>,
                Bound<'_, PyString>,
                Bound<'_, PyAny>,
            ) = method?.extract()?;
            if !owner.as_ref().unwrap_or(class).getattr(name)?.is(&original) {
                intact.store(false, Relaxed);
            }
        }
        Ok(Self { names, intact })
    }

    /// No method was replaced.
    #[inline]
    pub(crate) fn are_intact(&self) -> bool {
        self.intact.load(Relaxed)
    }

    /// `object.name = value`, which may replace a method of this object.
    pub(crate) fn set_attribute(
        &self,
        object: &Bound<'_, PyAny>,
        name: &Bound<'_, PyString>,
        value: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        if self.names.contains(&name.to_str()?) {
            self.intact.store(false, Relaxed);
        }
        generic_setattr(object, name, Some(value))
    }
}
