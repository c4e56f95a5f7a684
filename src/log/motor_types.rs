//! What a study says of a motor and its controller: plain data, SI units.

/// How a setpoint is read between two of its samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hold {
    /// The last sample's value stays.
    #[default]
    Step,
    /// A straight line from sample to sample.
    Linear,
}

/// What the derivative term of the controller acts on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Derivative {
    /// `-kd dq`.
    #[default]
    Measurement,
    /// `kd (dq_ref - dq)`; needs [`Hold::Linear`].
    Error,
}

/// Table `[motor]`: `tau = kp (q_ref - q) + ki integral - kd dq` on the joint angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorSpec {
    /// \[N m/rad\]
    pub kp_nm_rad: f64,
    /// \[N m/(rad s)\]
    pub ki_nm_rad_s: f64,
    /// \[N m s/rad\]
    pub kd_nm_s_rad: f64,
    /// How a setpoint is read between its samples.
    pub hold: Hold,
    /// What the derivative term acts on.
    pub derivative: Derivative,
    /// Period at which the law itself is evaluated \[s\]; `None`: continuously.
    pub sample_period_s: Option<f64>,
    /// Torque limit that the engineer already models \[N m\].
    pub torque_limit_nm: Option<f64>,
    /// Speed limit that the engineer already models \[rad/s\], with the torque limit as stall torque.
    pub speed_limit_rad_s: Option<f64>,
    /// What turns the law's answer into torque.
    pub model: MotorModel,
    /// The side of the gearing on which the encoder sits that the controller reads and the log shows.
    pub encoder: EncoderSide,
    /// Inertia of rotor and gears as the joint feels it, beside that of the link \[kg m^2\].
    pub armature_kg_m2: f64,
}

/// What turns the answer of the control law into torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum MotorModel {
    /// The law's answer is a torque \[N m\].
    #[default]
    Torque,
    /// The law's answer is a duty \[-1 to 1\] of the supply.
    Voltage(VoltageMotor),
}

/// A motor fed by voltage: `torque = kt (duty supply - kt q') / resistance`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltageMotor {
    /// Torque constant after the gear \[N m/A\].
    pub kt_nm_a: f64,
    /// \[Ohm\]
    pub resistance_ohm: f64,
    /// \[V\]
    pub supply_v: f64,
    /// Largest duty, 1 where nothing is said.
    pub duty_limit: f64,
}

impl VoltageMotor {
    /// Torque at standstill at full duty \[N m\].
    pub fn stall_nm(&self) -> f64 {
        self.kt_nm_a * self.supply_v / self.resistance_ohm
    }

    /// What its back-EMF takes off the torque per speed \[N m s/rad\].
    pub fn braking_nm_s_rad(&self) -> f64 {
        self.kt_nm_a * self.kt_nm_a / self.resistance_ohm
    }
}

/// A side of the gearing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EncoderSide {
    /// Behind the gears: the angle of the link.
    #[default]
    Link,
    /// Before them: the rotor's angle, as the link would have it without play or give.
    Motor,
}

impl MotorSpec {
    /// Torque at standstill per unit of the law's answer: 1, or that of full duty \[N m\].
    pub fn nm_per_answer(&self) -> f64 {
        match self.model {
            MotorModel::Torque => 1.0,
            MotorModel::Voltage(motor) => motor.stall_nm(),
        }
    }

    /// A proportional-derivative law, continuous, on a held setpoint, without limits.
    pub fn pd(kp_nm_rad: f64, kd_nm_s_rad: f64) -> Self {
        Self {
            kp_nm_rad,
            ki_nm_rad_s: 0.0,
            kd_nm_s_rad,
            hold: Hold::default(),
            derivative: Derivative::default(),
            sample_period_s: None,
            torque_limit_nm: None,
            speed_limit_rad_s: None,
            model: MotorModel::default(),
            encoder: EncoderSide::default(),
            armature_kg_m2: 0.0,
        }
    }
}

/// What a `tau` column of a position-driven log is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TauIs {
    /// The torque that arrives at the joint \[N m\].
    Applied,
    /// What the law asks for, before gain and limits \[N m\].
    Commanded,
    /// A motor current \[A\]; times this it is the applied torque \[N m/A\].
    Current {
        /// `kt gear`
        nm_per_a: f64,
    },
}
