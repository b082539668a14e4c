//! How far a vehicle went, from one position to the next.

use pyo3::prelude::*;

use crate::calling::Calling;
use crate::lock::Lock;

/// Metres: the mean radius of the Earth.
const RADIUS: f64 = 6_371_000.0;

/// A point on a sphere, in radians.
#[derive(Clone, Copy)]
struct Place {
    lat: f64,
    lon: f64,
    cos_lat: f64,
}

impl Place {
    fn new(lat: f64, lon: f64) -> Self {
        let lat = lat.to_radians();
        Self { lat, lon: lon.to_radians(), cos_lat: lat.cos() }
    }

    /// Metres between two points (haversine).
    fn distance(self, to: Self) -> f64 {
        let (lat, lon) = (to.lat - self.lat, to.lon - self.lon);
        let a = (lat / 2.0).sin().powi(2) + (lon / 2.0).sin().powi(2) * self.cos_lat * to.cos_lat;
        RADIUS * 2.0 * a.sqrt().atan2((1.0 - a).max(0.0).sqrt())
    }
}

/// Latitude and longitude in degrees.
type Degrees = (f64, f64);

#[derive(Default)]
struct Way {
    metres: f64,
    start: Option<Degrees>,
    end: Option<Degrees>,
    last: Option<Place>,
    stamp: Option<Py<PyAny>>,
}

impl Way {
    fn add(&mut self, lat: f64, lon: f64) {
        let place = Place::new(lat, lon);
        if let Some(last) = self.last.replace(place) {
            self.metres += last.distance(place);
        }
        self.start = self.start.or(Some((lat, lon)));
        self.end = Some((lat, lon));
    }
}

/// The length of a way in `metres`, and the positions (degrees) at its `start` and `end`.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct Track(Lock<Way>);

#[pymethods]
impl Track {
    #[new]
    fn new() -> Self {
        Self(Lock::new(Way::default()))
    }

    /// Goes on to a position, in degrees. One whose stamp is the last one's is the same one.
    fn add(&self, lat: f64, lon: f64, stamp: Bound<'_, PyAny>) -> PyResult<()> {
        let state = || self.0.lock(stamp.py());
        let before = state().stamp.replace(stamp.clone().unbind());
        let is_same = before.map_or(Ok(false), |before| before.bind(stamp.py()).equals(&stamp))?;
        if !is_same {
            state().add(lat, lon);
        }
        Ok(())
    }

    #[getter]
    fn metres(&self, py: Python<'_>) -> f64 {
        self.0.lock(py).metres
    }

    #[getter]
    fn start(&self, py: Python<'_>) -> Option<Degrees> {
        self.0.lock(py).start
    }

    #[getter]
    fn end(&self, py: Python<'_>) -> Option<Degrees> {
        self.0.lock(py).end
    }
}
