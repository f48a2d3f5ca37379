!> Laminar flows with exact solutions: between plates, and in a square duct.
module laminar_flows
  use communicator, only: communicator_t
  use constants, only: pi
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, make_gas, steps
  use kinds, only: wp
  use outcome, only: outcome_t
  implicit none
  private
  public :: flow_scene, plates_error, plates_drop, couette_error, duct_error, duct_velocity

  real(wp), parameter, public :: gap = 0.01_wp, viscosity = 1.0e-3_wp
  real(wp), parameter, public :: length = 0.2_wp, drop = 240.0_wp

contains

  !> Between plates, n cells apart, driven by a pressure drop of 240 Pa over 0.2 m: the largest distance from
  !> u = dp/dx y (H - y)/(2 mu) [m/s].
  subroutine plates_error(comm, n, worst, ok)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: n
    real(wp), intent(out) :: worst
    logical, intent(out) :: ok  !< whether the steps converged

    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: y, exact
    integer :: j

    scene = flow_scene([length, gap, gap], [n, n, 1], [.true., .false., .false.])
    scene%records = [record('front', 'slip', [0.0_wp, 0.0_wp, 0.0_wp], [length, gap, 0.0_wp]), &
                     record('back', 'slip', [0.0_wp, 0.0_wp, gap], [length, gap, gap])]
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 4, 10.0_wp)
    worst = 0.0_wp
    do j = 1, gas%boxes%n(2)
      y = (gas%boxes%lo(2) + j - 1.5_wp)*gas%mesh%finest(2)
      exact = drop/length*y*(gap - y)/(2*viscosity)
      worst = max(worst, maxval(abs(gas%velocity(1:gas%boxes%n(1), j, 1, 1) - exact)))
    end do
    worst = comm%max(worst)
    call gas%destroy()
  end subroutine plates_error

  !> The pressure drop that is found for the mass flow of the same plates at 240 Pa, less what the cells' sum misses of the
  !> integral of a parabola [Pa].
  subroutine plates_drop(comm, n, found, ok)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: n
    real(wp), intent(out) :: found
    logical, intent(out) :: ok  !< whether the steps converged

    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome

    scene = flow_scene([length, gap, gap], [n, n, 1], [.true., .false., .true.])
    scene%settings%pressure_drop = 0.0_wp
    scene%settings%flow_given = .true.
    scene%settings%mass_flow = 0.0_wp
    scene%settings%mass_flow(1) = drop/length*gap**4/(12*viscosity)*(1 + 0.5_wp/n**2)
    allocate (scene%records(0))
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 4, 10.0_wp)
    found = gas%driving%drop(1)
    call gas%destroy()
  end subroutine plates_drop

  !> Between a plate at rest and one of 10 m/s, 3 by n cells of 1 m by 0.01 m, with a pressure drop [Pa]: the largest distance
  !> from u = U y/H + dp/dx y (H - y)/(2 mu) [m/s].
  subroutine couette_error(comm, n, pressure_drop, worst, ok)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: n
    real(wp), intent(in) :: pressure_drop
    real(wp), intent(out) :: worst
    logical, intent(out) :: ok  !< whether the steps converged

    real(wp), parameter :: edge = 1.0_wp, thin = 5.0e-6_wp, lid = 10.0_wp
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: y, exact
    integer :: j

    scene = flow_scene([edge, gap, gap], [3, n, 1], [.true., .false., .true.])
    scene%settings%pressure_drop(1) = pressure_drop
    scene%settings%viscosity = thin
    scene%numerics%velocity_tolerance = 1.0e-8_wp
    allocate (scene%records(1))
    scene%records(1) = record('lid', 'no_slip', [0.0_wp, gap, 0.0_wp], [edge, gap, gap])
    scene%records(1)%wall_velocity(1) = lid
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 150, 0.3_wp)
    worst = 0.0_wp
    do j = 1, gas%boxes%n(2)
      y = (gas%boxes%lo(2) + j - 1.5_wp)*gas%mesh%finest(2)
      exact = lid*y/gap + pressure_drop/edge*y*(gap - y)/(2*thin)
      worst = max(worst, maxval(abs(gas%velocity(1:gas%boxes%n(1), j, 1, 1) - exact)))
    end do
    worst = comm%max(worst)
    call gas%destroy()
  end subroutine couette_error

  !> In a square duct of n by n cells, where the parabola is not exact: root mean square error of the velocity [m/s].
  subroutine duct_error(comm, n, error, ok)
    type(communicator_t), intent(in) :: comm
    integer, intent(in) :: n
    real(wp), intent(out) :: error
    logical, intent(out) :: ok  !< whether the steps converged

    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: y, z
    integer :: j, k

    scene = flow_scene([gap, gap, gap], [2, n, n], [.true., .false., .false.])
    allocate (scene%records(0))
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 4, 10.0_wp)
    error = 0.0_wp
    do k = 1, gas%boxes%n(3)
      do j = 1, gas%boxes%n(2)
        y = (gas%boxes%lo(2) + j - 1.5_wp)*gas%mesh%finest(2)
        z = (gas%boxes%lo(3) + k - 1.5_wp)*gas%mesh%finest(3)
        error = error + (gas%velocity(1, j, k, 1) - duct_velocity(y - gap/2, z - gap/2))**2/n**2
      end do
    end do
    error = sqrt(comm%sum(error))
    call gas%destroy()
  end subroutine duct_error

  !> Velocity in a square duct of half width a, y and z from its axis: the series of White, Viscous Fluid
  !> Flow, eq. 3-48 [m/s].
  pure function duct_velocity(y, z) result(u)
    real(wp), intent(in) :: y, z
    real(wp) :: u

    real(wp), parameter :: a = gap/2
    integer :: i
    real(wp) :: m

    u = 0.0_wp
    do i = 1, 199, 2
      m = i*pi/(2*a)
      ! cosh(m z)/cosh(m a) without overflow
      u = u + (-1)**((i - 1)/2)*cos(m*y)/real(i, wp)**3 &
        *(1 - (exp(m*(abs(z) - a)) + exp(-m*(abs(z) + a)))/(1 + exp(-2*m*a)))
    end do
    u = u*16*a**2/(viscosity*pi**3)*drop/length
  end function duct_velocity

  function flow_scene(upper, cells, periodic) result(scene)
    real(wp), intent(in) :: upper(3)
    integer, intent(in) :: cells(3)
    logical, intent(in) :: periodic(3)
    type(scene_t) :: scene

    scene%upper = upper
    scene%cells = cells
    scene%periodic = periodic
    scene%settings%pressure_drop = [drop, 0.0_wp, 0.0_wp]*upper(1)/length
    scene%settings%density = 1.0_wp
    scene%settings%viscosity = viscosity
    scene%numerics%velocity_tolerance = 1.0e-11_wp
    scene%numerics%maximum_iterations = 100
  end function flow_scene

end module laminar_flows
