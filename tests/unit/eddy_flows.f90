!> Flows with eddies smaller than the cells whose mixing length l = C_s Delta is held, so that there are exact solutions.
module eddy_flows
  use communicator, only: communicator_t
  use constants, only: gas_constant, pi
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, make_gas, steps
  use gas_settings, only: make_ideal
  use grid_axis, only: axis_t, graded_axis
  use kinds, only: wp
  use outcome, only: outcome_t
  use pipe_flow, only: pipe
  implicit none
  private
  public :: channel_error, channel_velocity, shear_force, pipe_error, wavy_axis

  real(wp), parameter, public :: gap = 0.01_wp, density = 1.5_wp, viscosity = 1.0e-3_wp
  real(wp), parameter, public :: gradient = 1200.0_wp  !< of the pressure [Pa/m]
  real(wp), parameter, public :: mixing = 1.2e-3_wp    !< length l [m]

contains

  !> A gap of n cells across b, joined to itself along a and the third direction.
  function channel_scene(a, b, n) result(scene)
    integer, intent(in) :: a, b, n
    type(scene_t) :: scene

    scene%cells = 4
    scene%cells(b) = n
    scene%upper = gap
    scene%periodic = .true.
    scene%periodic(b) = .false.
    scene%settings%density = density
    scene%settings%viscosity = viscosity
    scene%settings%turbulence_model = 'smagorinsky'
    scene%settings%smagorinsky_constant = mixing/product(scene%upper/scene%cells)**(1.0_wp/3.0_wp)
    scene%numerics%velocity_tolerance = 1.0e-10_wp
    scene%numerics%tolerance = 1.0e-10_wp
    scene%numerics%maximum_iterations = 100
    scene%settings%velocity(a) = 1.0_wp
    allocate (scene%records(0))
  end function channel_scene

  !> Along a between plates at rest across b, n cells apart, driven by a pressure drop: the largest distance from
  !> channel_velocity [m/s].
  subroutine channel_error(comm, a, b, n, worst, ok, ideal)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: a, b, n
    real(wp), intent(out) :: worst
    logical, intent(out) :: ok                !< whether the steps converged
    logical, intent(in), optional :: ideal    !< a gas of the same density, of M = 0.03 kg/mol at 300 K

    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    integer :: i, j, k, x(3)
    real(wp) :: y

    scene = channel_scene(a, b, n)
    scene%settings%pressure_drop(a) = gradient*scene%upper(a)
    if (present(ideal)) call pressurize(scene)
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 60, 2.0e-3_wp)
    worst = 0.0_wp
    do k = 1, gas%boxes%n(3)
      do j = 1, gas%boxes%n(2)
        do i = 1, gas%boxes%n(1)
          x = gas%boxes%lo + [i, j, k] - 1
          y = gas%mesh%axis(b)%in_metres(x(b) - 0.5_wp)
          worst = max(worst, abs(gas%velocity(i, j, k, a) - channel_velocity(y)))
        end do
      end do
    end do
    worst = comm%max(worst)
    call gas%destroy()
  end subroutine channel_error

  !> An ideal gas that has the density where the pressure is 0.
  subroutine pressurize(scene)
    type(scene_t), intent(inout) :: scene

    scene%settings%molar_mass = 0.03_wp
    scene%settings%temperature = 300.0_wp
    scene%settings%reference_pressure = density*gas_constant*300.0_wp/0.03_wp
    call make_ideal(scene%settings)
  end subroutine pressurize

  !> The solution of (mu + rho l^2 |u'|) u' = G (H/2 - y), u(0) = u(H) = 0:
  !>   u' = (R - mu)/(2 rho l^2),  R = sqrt(mu^2 + 4 rho l^2 G (H/2 - y)) in the lower half [m/s].
  pure function channel_velocity(y) result(u)
    real(wp), intent(in) :: y  !< from the lower plate [m]
    real(wp) :: u

    real(wp) :: below, steep(2)

    below = min(y, gap - y)
    steep = viscosity**2 + 4*density*mixing**2*gradient*[0.5_wp*gap, 0.5_wp*gap - below]
    u = ((steep(1)**1.5_wp - steep(2)**1.5_wp)/(6*density*mixing**2*gradient) - viscosity*below)/(2*density*mixing**2)
  end function channel_velocity

  !> Between two plates across b of which the upper one moves along a at speed U and the lower one at -U/2: the largest distance
  !> from the straight line, and the force per area between the plates from the middle of the gap, over
  !> (mu + rho l^2 U'/H) U'/H with U' = 3/2 U.
  subroutine shear_force(comm, a, b, n, worst, force, ok)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: a, b, n
    real(wp), intent(out) :: worst, force
    logical, intent(out) :: ok

    real(wp), parameter :: speed = 4.0_wp
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    integer :: j, m, x(3), y(3), e(3)
    real(wp) :: slope, exact

    scene = channel_scene(a, b, n)
    scene%records = [record('low', 'no_slip', [0.0_wp, 0.0_wp, 0.0_wp], scene%upper), &
                     record('high', 'no_slip', [0.0_wp, 0.0_wp, 0.0_wp], scene%upper)]
    scene%records(1)%upper(b) = 0.0_wp
    scene%records(2)%lower(b) = gap
    scene%records(1)%wall_velocity(a) = -0.5_wp*speed
    scene%records(2)%wall_velocity(a) = speed
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 40, 2.0e-3_wp)
    slope = 1.5_wp*speed/gap
    worst = 0.0_wp
    force = huge(1.0_wp)
    e = 0
    e(b) = 1
    do j = 1, gas%boxes%n(b)
      m = gas%boxes%lo(b) + j - 1
      x = 1
      x(b) = j
      exact = -0.5_wp*speed + slope*gas%mesh%axis(b)%in_metres(m - 0.5_wp)
      worst = max(worst, abs(gas%velocity(x(1), x(2), x(3), a) - exact))
      if (m /= n/2) cycle
      y = x + e
      force = gas%viscosity*0.5_wp*(gas%eddies%eps(x(1), x(2), x(3)) + gas%eddies%eps(y(1), y(2), y(3))) &
        *(gas%velocity(y(1), y(2), y(3), a) - gas%velocity(x(1), x(2), x(3), a))*n/gap
    end do
    worst = comm%max(worst)
    force = comm%min(force)/((viscosity + density*mixing**2*slope)*slope)
    call gas%destroy()
  end subroutine shear_force

  !> Flow along a pipe of the gap's diameter whose wall cuts cells, n across it and one more at either end: its error over that of
  !>   (mu + rho l^2 |u'|) u' = -G r/2,  flow = pi times the integral of r^2 |u'|.
  subroutine pipe_error(comm, n, error, ok)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: n
    real(wp), intent(out) :: error
    logical, intent(out) :: ok

    integer, parameter :: rings = 2000
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: cell, flow, r, exact
    integer :: m

    cell = gap/n
    scene = channel_scene(2, 1, n + 2)
    scene%cells = [n + 2, 4, n + 2]
    scene%upper = [(n + 2)*cell, 4*cell, (n + 2)*cell]
    scene%periodic = [.false., .true., .false.]
    scene%settings%smagorinsky_constant = mixing/cell
    scene%settings%pressure_drop(2) = gradient*scene%upper(2)
    scene%walls = [pipe([0.5_wp*scene%upper(1) + 0.21_wp*cell, 0.0_wp, 0.5_wp*scene%upper(3) - 0.13_wp*cell], 2, 0.5_wp*gap)]
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 40, 2.0e-3_wp)
    associate (b => gas%boxes%n)
      flow = comm%sum(sum(gas%flux(1:b(1), 1:b(2), 1:b(3), 2)))/(gas%mesh%n(2)*density)
    end associate
    call gas%destroy()
    exact = 0.0_wp
    do m = 1, rings
      r = 0.5_wp*gap*(m - 0.5_wp)/rings
      exact = exact + pi*r**2*(sqrt(viscosity**2 + 2*density*mixing**2*gradient*r) - viscosity)/(2*density*mixing**2) &
        *0.5_wp*gap/rings
    end do
    error = flow/exact - 1
  end subroutine pipe_error

  !> A unit length of n cells, joined to itself or not, as wide as 1 + wave cos(2 pi s) at s n.
  pure function wavy_axis(n, wave, periodic) result(axis)
    integer, intent(in) :: n
    real(wp), intent(in) :: wave
    logical, intent(in) :: periodic
    type(axis_t) :: axis

    integer :: i

    axis = graded_axis([((real(i, wp)/n + wave*sin(2*pi*i/n)/(2*pi)), i=0, n - 1), 1.0_wp], periodic)
  end function wavy_axis

end module eddy_flows
