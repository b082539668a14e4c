//! Properties of Python classes that only read and write one place.

/// Python properties and where their values are: atomic numbers or slots of the object, or fields of its state.
macro_rules! properties {
    (@get (atomic $place:expr)) => { $place.load(::std::sync::atomic::Ordering::Relaxed) };
    (@get (slot $place:expr)) => { Python::attach(|py| $place.get(py).map(Bound::unbind)) };
    (@get (field $place:expr)) => { $place };
    (@set (atomic $place:expr) $value:ident) => {
        $place.store($value, ::std::sync::atomic::Ordering::Relaxed)
    };
    (@set (slot $place:expr) $value:ident) => { $place.set($value) };
    (@set (field $place:expr) $value:ident) => { $place = $value };
    ($class:ident: $($(#[$doc:meta])* $name:ident, $set:ident: $type:ty = |$this:ident| $place:tt;)+) => {
        #[pymethods]
        #[allow(non_snake_case)] // names of pymavlink
        impl $class {
            $(
                $(#[$doc])*
                #[getter]
                fn $name(&self) -> $type {
                    let $this = self;
                    properties!(@get $place)
                }
                #[setter($name)]
                fn $set(&self, value: $type) {
                    let $this = self;
                    properties!(@set $place value);
                }
            )+
        }
    };
}
