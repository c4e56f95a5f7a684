//! A robot's rigid-body dynamics.

use crate::errors::Failed;
use aibo_fit::robot::description::Description;
use aibo_fit::robot::tree::{Tree, TreeBase, TreeDynamics, TreeState};
use nalgebra::{DMatrix, Quaternion, UnitQuaternion, Vector3};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, ToPyArray};
use pyo3::prelude::*;
use std::path::PathBuf;

/// A robot as its URDF, MJCF or TOML describes it.
#[pyclass(frozen, module = "aibo_fit._core")]
pub struct Robot {
    description: Description,
    tree: Tree,
}

/// A base's place, orientation (w, x, y, z), velocity and angular velocity.
type Base = ([f64; 3], [f64; 4], [f64; 3], [f64; 3]);
type Array<'py> = Option<PyReadonlyArray1<'py, f64>>;

#[pymethods]
impl Robot {
    #[staticmethod]
    #[pyo3(signature = (path, base=None, gravity=None))]
    fn from_file(py: Python<'_>, path: PathBuf, base: Option<&str>, gravity: Option<[f64; 3]>) -> PyResult<Self> {
        let description = py.detach(|| Description::read(&path).map_err(Failed::of))?;
        let base = match base {
            None => Tree::base_of(&description),
            Some("fixed") => TreeBase::Fixed,
            Some("free") => TreeBase::Free,
            Some(other) => return Err(Failed::of(format!("base `{other}`: expected fixed or free")).into()),
        };
        let tree = Tree::new(&description, base).map_err(|error| Failed::of(format!("{}: {error}", path.display())))?;
        let tree = gravity.map_or_else(|| tree.clone(), |[x, y, z]| tree.with_gravity(Vector3::new(x, y, z)));
        Ok(Self { description, tree })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.description.name
    }

    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.tree.joint_names().map(str::to_owned).collect()
    }

    #[getter]
    fn base(&self) -> &'static str {
        if self.tree.base() == TreeBase::Free { "free" } else { "fixed" }
    }

    #[getter]
    fn freedoms(&self) -> usize {
        self.tree.freedoms()
    }

    #[getter]
    fn mass(&self) -> f64 {
        self.description.total_mass_kg()
    }

    #[getter]
    fn gravity(&self) -> [f64; 3] {
        self.tree.gravity_m_s2().into()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.description.warnings.clone()
    }

    #[pyo3(signature = (q, base=None))]
    fn mass_matrix<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray1<'_, f64>,
        base: Option<Base>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let state = self.state(Some(q), None, base)?;
        let n = self.tree.freedoms();
        let mut matrix = DMatrix::zeros(n, n);
        TreeDynamics::new(&self.tree).mass_matrix(&state, &mut matrix);
        // Symmetric: columns are rows.
        let rows: Vec<Vec<f64>> = matrix.column_iter().map(|column| column.iter().copied().collect()).collect();
        Ok(PyArray2::from_vec2(py, &rows)?)
    }

    #[pyo3(signature = (q, dq=None, base=None))]
    fn bias<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray1<'_, f64>,
        dq: Array<'_>,
        base: Option<Base>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let state = self.state(Some(q), dq, base)?;
        let mut bias = vec![0.0; self.tree.freedoms()];
        TreeDynamics::new(&self.tree).bias(&state, &mut bias);
        Ok(bias.to_pyarray(py))
    }

    #[pyo3(signature = (q, dq, ddq, base=None))]
    fn inverse<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray1<'_, f64>,
        dq: PyReadonlyArray1<'_, f64>,
        ddq: PyReadonlyArray1<'_, f64>,
        base: Option<Base>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let ahead = self.of_freedoms("ddq", &ddq)?;
        self.answered(py, [q, dq], base, |dynamics, state, force| {
            dynamics.inverse(state, &ahead, force);
            Ok(())
        })
    }

    #[pyo3(signature = (q, dq, tau, base=None))]
    fn forward<'py>(
        &self,
        py: Python<'py>,
        q: PyReadonlyArray1<'_, f64>,
        dq: PyReadonlyArray1<'_, f64>,
        tau: PyReadonlyArray1<'_, f64>,
        base: Option<Base>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let of_base = std::iter::repeat_n(0.0, self.tree.base_freedoms());
        let force: Vec<f64> = of_base.chain(self.of_joints("tau", &tau)?).collect();
        self.answered(py, [q, dq], base, |dynamics, state, ahead| {
            dynamics.forward(state, &force, ahead).map_err(Failed::of)
        })
    }
}

impl Robot {
    /// A number for each freedom, in a state.
    fn answered<'py>(
        &self,
        py: Python<'py>,
        [q, dq]: [PyReadonlyArray1<'_, f64>; 2],
        base: Option<Base>,
        work: impl FnOnce(&mut TreeDynamics<'_>, &TreeState, &mut [f64]) -> Result<(), Failed>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let state = self.state(Some(q), Some(dq), base)?;
        let mut answer = vec![0.0; self.tree.freedoms()];
        work(&mut TreeDynamics::new(&self.tree), &state, &mut answer)?;
        Ok(answer.to_pyarray(py))
    }

    fn state(&self, q: Array<'_>, dq: Array<'_>, base: Option<Base>) -> Result<TreeState, Failed> {
        let mut state = TreeState::drawn(&self.tree);
        if let Some(q) = q {
            state.position = self.of_joints("q", &q)?;
        }
        if let Some(dq) = dq {
            state.rate = self.of_joints("dq", &dq)?;
        }
        let Some((place, [w, x, y, z], velocity, rate)) = base else { return Ok(state) };
        if self.tree.base() == TreeBase::Fixed {
            return Err(Failed::of("the base is fixed: read the robot with base=\"free\" to move it"));
        }
        let turned = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-9);
        state.base_orientation = turned.ok_or_else(|| Failed::of("the base's quaternion is nothing"))?;
        state.base_position_m = place.into();
        state.base_velocity_m_s = velocity.into();
        state.base_rate_rad_s = rate.into();
        Ok(state)
    }

    fn of_joints(&self, name: &str, array: &PyReadonlyArray1<'_, f64>) -> Result<Vec<f64>, Failed> {
        counted(name, array, self.tree.joints().len(), "the joints in `joint_names`")
    }

    fn of_freedoms(&self, name: &str, array: &PyReadonlyArray1<'_, f64>) -> Result<Vec<f64>, Failed> {
        counted(name, array, self.tree.freedoms(), "the freedoms, the base's first where it is free")
    }
}

fn counted(name: &str, array: &PyReadonlyArray1<'_, f64>, expected: usize, of: &str) -> Result<Vec<f64>, Failed> {
    let values = array.as_array().to_vec();
    if values.len() != expected {
        return Err(Failed::of(format!("`{name}`: {} values, expected {expected}: {of}", values.len())));
    }
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        return Err(Failed::of(format!("`{name}`[{at}]: {}, expected a finite number", values[at])));
    }
    Ok(values)
}
