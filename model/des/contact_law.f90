!> The law of contacts of one pair of materials, as the case chose it. It is asked for a block of pairs at a time, so
!> that the choice costs nothing.
module contact_law
  use cohesion, only: cohesion_t
  use constants, only: pi
  use contact_hertz, only: hertz_t, new_hertz, hertz_friction_forces, hertz_frictionless_forces
  use contact_lanes, only: lanes, record_rows
  use contact_linear, only: linear_t, new_linear, linear_friction_forces, linear_frictionless_forces
  use contact_pairs, only: pair_t
  use contact_settings, only: contact_settings_t
  use kinds, only: wp
  use rolling, only: rolling_t
  implicit none
  private
  public :: contact_law_t, new_law, friction_forces, frictionless_forces

  type :: contact_law_t
    logical :: hertzian = .false.    !< whether it is `hertz`, else `linear`
    type(linear_t) :: linear
    type(hertz_t) :: hertz
    real(wp) :: mu = 0.0_wp          !< Coulomb friction [-]
    type(rolling_t) :: rolling       !< resistance to rolling, if there is any
    type(cohesion_t) :: cohesion     !< attraction, if there is any
  contains
    procedure :: set_step
    procedure :: contact_time
  end type contact_law_t

contains

  !> Between two partners of a pair of materials.
  pure function new_law(settings, pair) result(law)
    type(contact_settings_t), intent(in) :: settings
    type(pair_t), intent(in) :: pair
    type(contact_law_t) :: law

    law%hertzian = settings%law == 'hertz'
    law%mu = pair%friction
    if (law%hertzian) then
      law%hertz = new_hertz(pair%one, pair%other, pair%restitution, pair%tangential_damping_ratio, law%mu)
    else
      law%linear = new_linear(pair%stiffness, pair%tangential_ratio, pair%restitution, pair%tangential_damping_ratio, law%mu)
    end if
    law%rolling = rolling_of(settings, pair, law)
    law%cohesion = cohesion_of(settings, pair)
  end function new_law

  !> Resistance to rolling, where there is any, beside a law that is complete but for it.
  pure function rolling_of(settings, pair, law) result(rolling)
    type(contact_settings_t), intent(in) :: settings
    type(pair_t), intent(in) :: pair
    type(contact_law_t), intent(in) :: law
    type(rolling_t) :: rolling

    if (settings%rolling == 'none' .or. .not. pair%rolling_friction > 0.0_wp) return
    rolling%on = .true.
    rolling%spring = settings%rolling == 'spring'
    rolling%hertzian = law%hertzian
    rolling%mu = pair%rolling_friction
    rolling%damping = pair%rolling_damping
    rolling%stiffness = merge(law%hertz%modulus, law%linear%k_n, law%hertzian)
  end function rolling_of

  !> Attraction, where there is any.
  pure function cohesion_of(settings, pair) result(cohesion)
    type(contact_settings_t), intent(in) :: settings
    type(pair_t), intent(in) :: pair
    type(cohesion_t) :: cohesion

    if (settings%cohesion == 'van_der_waals' .and. pair%hamaker_constant > 0.0_wp) then
      cohesion = cohesion_t(.true., .true., pair%hamaker_constant/6, settings%minimum_separation, settings%maximum_separation)
    else if (settings%cohesion == 'linear' .and. pair%cohesion_energy > 0.0_wp) then
      cohesion = cohesion_t(.true., .false., pi*pair%cohesion_energy)
    end if
  end function cohesion_of

  !> The length of the steps that follow.
  elemental subroutine set_step(self, dt)
    class(contact_law_t), intent(inout) :: self
    real(wp), intent(in) :: dt  !< [s]

    call self%linear%set_step(dt)
    self%hertz%dt = dt
  end subroutine set_step

  !> Time a collision takes, or half a swing of the rolling spring if that is shorter [s].
  pure function contact_time(self, effective_mass, effective_radius, speed) result(time)
    class(contact_law_t), intent(in) :: self
    real(wp), intent(in) :: effective_mass    !< [kg]
    real(wp), intent(in) :: effective_radius  !< hertz: [m]
    real(wp), intent(in) :: speed             !< hertz: of the approach [m/s]
    real(wp) :: time

    if (self%hertzian) then
      time = self%hertz%contact_time(effective_mass, effective_radius, speed)
    else
      time = self%linear%contact_time(effective_mass)
    end if
    time = time/self%rolling%hurry()
  end function contact_time

  !> Forces of n pairs with friction, n a multiple of `lanes`, none on those that do not touch: see `linear_friction_forces`.
  pure subroutine friction_forces(law, n, pair, spin, record, force)
    type(contact_law_t), intent(in) :: law
    integer, intent(in) :: n
    real(wp), intent(in) :: pair(8, n)     !< x_i - x_j, r_i + r_j [m], v_i - v_j [m/s], 1/m_i + 1/m_j [1/kg]
    real(wp), intent(in) :: spin(4, n)     !< r_i omega_i + r_j omega_j [m/s], 1/r_i + 1/r_j [1/m]
    real(wp), intent(inout) :: record(lanes, record_rows, n/lanes)  !< see contact_lanes
    real(wp), intent(out) :: force(8, n)   !< 1:3 force on i, 5:7 torque over radius [N]

    if (law%hertzian) then
      call hertz_friction_forces(law%hertz, n, pair, spin, record, force)
    else
      call linear_friction_forces(law%linear, n, pair, spin, record, force)
    end if
  end subroutine friction_forces

  !> The same without friction.
  pure subroutine frictionless_forces(law, n, pair, curvature, force)
    type(contact_law_t), intent(in) :: law
    integer, intent(in) :: n
    real(wp), intent(in) :: pair(8, n)     !< as above
    real(wp), intent(in) :: curvature(n)   !< 1/r_i + 1/r_j [1/m]; read by hertz only
    real(wp), intent(out) :: force(4, n)   !< 1:3 force on i [N]

    if (law%hertzian) then
      call hertz_frictionless_forces(law%hertz, n, pair, curvature, force)
    else
      call linear_frictionless_forces(law%linear, n, pair, force)
    end if
  end subroutine frictionless_forces

end module contact_law
