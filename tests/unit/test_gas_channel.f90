!> Laminar flows with exact solutions: viscous terms, walls, momentum solver, order of accuracy.
program test_gas_channel
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, make_gas, steps
  use kinds, only: wp
  use outcome, only: outcome_t
  implicit none

  real(wp), parameter :: gap = 0.01_wp, length = 0.2_wp, viscosity = 1.0e-3_wp, drop = 240.0_wp
  type(communicator_t) :: comm

  call start_ranks(comm)
  call plates()
  call duct()
  call stopping_plate()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> Between plates, driven by a body force of 240 Pa over 0.2 m: u = dp/dx y (H - y)/(2 mu). The errors of MFIX on the
  !> same grids are .234, .0586, .0146, .00366 m/s. The parabola at the wall makes ours vanish.
  subroutine plates()
    real(wp), parameter :: mfix(4) = [0.234_wp, 0.0586_wp, 0.0146_wp, 0.00366_wp]
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: worst, y, exact
    integer :: level, n, j
    logical :: ok
    character(len=8) :: cells

    do level = 1, 4
      n = 4*2**level
      scene = flow_scene([length, gap, gap], [n, n, 1], [.true., .false., .false.])
      scene%records = [record('front', 'slip', [0.0_wp, 0.0_wp, 0.0_wp], [length, gap, 0.0_wp]), &
                       record('back', 'slip', [0.0_wp, 0.0_wp, gap], [length, gap, gap])]
      call make_gas(comm, scene, gas, outcome)
      ok = steps(gas, 4, 10.0_wp)
      worst = 0.0_wp
      do j = 1, gas%boxes%n(2)
        y = (gas%boxes%lo(2) + j - 1.5_wp)*gas%mesh%h(2)
        exact = drop/length*y*(gap - y)/(2*viscosity)
        worst = max(worst, maxval(abs(gas%velocity(1:gas%boxes%n(1), j, 1, 1) - exact)))
      end do
      worst = comm%max(worst)
      call gas%destroy()
      if (.not. comm%is_root()) cycle
      write (cells, '(i0)') n
      call expect(ok, 'plates converge on '//trim(cells)//' cells')
      call expect(worst < mfix(level)/2, 'plates, error below half of the mark')
      call expect_close(worst, 0.0_wp, 1.0e-7_wp, 'plates, largest error of 15 m/s')
    end do
  end subroutine plates

  !> In a square duct, where the parabola is not exact: the series of White, Viscous Fluid Flow, eq. 3-48.
  subroutine duct()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: error(3), y, z
    integer :: level, n, j, k
    logical :: ok

    do level = 1, 3
      n = 8*2**level
      scene = flow_scene([gap, gap, gap], [2, n, n], [.true., .false., .false.])
      allocate (scene%records(0))
      call make_gas(comm, scene, gas, outcome)
      ok = steps(gas, 4, 10.0_wp)
      error(level) = 0.0_wp
      do k = 1, gas%boxes%n(3)
        do j = 1, gas%boxes%n(2)
          y = (gas%boxes%lo(2) + j - 1.5_wp)*gas%mesh%h(2)
          z = (gas%boxes%lo(3) + k - 1.5_wp)*gas%mesh%h(3)
          error(level) = error(level) + (gas%velocity(1, j, k, 1) - duct_velocity(y - gap/2, z - gap/2))**2/n**2
        end do
      end do
      error(level) = sqrt(comm%sum(error(level)))
      call gas%destroy()
      if (comm%is_root()) call expect(ok, 'duct converges')
    end do
    if (.not. comm%is_root()) return
    ! the parabola at the wall adds a smaller term of third order, so the limit 2 is approached from below
    call expect(log(error(2)/error(3))/log(2.0_wp) > 1.85_wp, 'duct: second order')
    call expect(error(3) < 2.0e-4_wp*duct_velocity(0.0_wp, 0.0_wp), 'duct: 0.02 % on 64 cells')
  end subroutine duct

  !> Velocity in a square duct of half width a, y and z from its axis.
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

  !> A flow along a slip plane and a wall dies as exp(-nu k^2 t) with k = pi/(2H): time scheme and viscosity.
  subroutine stopping_plate()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: rate, before, after
    integer :: j
    logical :: ok
    integer, parameter :: n = 32, count = 100
    real(wp), parameter :: dt = 1.0e-4_wp

    scene = flow_scene([gap, gap, gap], [2, n, 1], [.true., .false., .true.])
    scene%gravity = 0.0_wp
    scene%settings%density = 2.0_wp
    scene%records = [record('top', 'slip', [0.0_wp, gap, 0.0_wp], [gap, gap, gap])]
    call make_gas(comm, scene, gas, outcome)
    do j = 1, gas%boxes%n(2)
      gas%velocity(:, j, :, 1) = sin(pi*(gas%boxes%lo(2) + j - 1.5_wp)/(2*n))
    end do
    before = comm%sum(sum(gas%velocity(1, 1:gas%boxes%n(2), 1, 1)))
    ok = steps(gas, count, dt)
    after = comm%sum(sum(gas%velocity(1, 1:gas%boxes%n(2), 1, 1)))
    call gas%destroy()
    if (.not. comm%is_root()) return
    rate = log(1 + dt*viscosity/2.0_wp*(pi/(2*gap))**2)/dt  ! implicit Euler's own decay
    call expect(ok, 'stopping flow converges')
    call expect_close(log(before/after)/(count*dt), rate, 1.0e-3_wp, 'stopping flow, rate of decay [1/s]')
  end subroutine stopping_plate

  function flow_scene(upper, cells, periodic) result(scene)
    real(wp), intent(in) :: upper(3)
    integer, intent(in) :: cells(3)
    logical, intent(in) :: periodic(3)
    type(scene_t) :: scene

    scene%upper = upper
    scene%cells = cells
    scene%periodic = periodic
    scene%gravity = [drop/length, 0.0_wp, 0.0_wp]
    scene%settings%density = 1.0_wp
    scene%settings%viscosity = viscosity
    scene%numerics%velocity_tolerance = 1.0e-11_wp
    scene%numerics%maximum_iterations = 100
  end function flow_scene

end program test_gas_channel
