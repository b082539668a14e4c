//! Properties of Python classes that are a number each.

/// Python properties and where their numbers are: atomic ones of the object, or fields of its state.
macro_rules! properties {
    (@get (atomic $place:expr)) => { $place.load(::std::sync::atomic::Ordering::Relaxed) };
    (@get (field $place:expr)) => { $place };
    (@set (atomic $place:expr) $value:ident) => {
        $place.store($value, ::std::sync::atomic::Ordering::Relaxed)
    };
    (@set (field $place:expr) $value:ident) => { $place = $value };
    ($class:ident: $($(#[$doc:meta])* $name:ident, $set:ident: $type:ident = |$this:ident| $place:tt;)+) => {
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
