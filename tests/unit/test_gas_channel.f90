!> Laminar flows with exact solutions: viscous terms, walls, momentum solver, order of accuracy.
program test_gas_channel
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use constants, only: pi
  use gas, only: gas_t
  use gas_cases, only: scene_t, record, make_gas, steps
  use kinds, only: wp
  use laminar_flows, only: duct_error, duct_velocity, flow_scene, gap, plates_error, viscosity
  use outcome, only: outcome_t
  implicit none

  type(communicator_t) :: comm

  call start_ranks(comm)
  call plates()
  call duct()
  call stopping_plate()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> Between plates the parabola at the wall makes the errors vanish.
  subroutine plates()
    real(wp) :: worst
    integer :: level
    logical :: ok
    character(len=8) :: cells

    do level = 3, 6
      call plates_error(comm, 2**level, worst, ok)
      if (.not. comm%is_root()) cycle
      write (cells, '(i0)') 2**level
      call expect(ok, 'plates converge on '//trim(cells)//' cells')
      call expect_close(worst, 0.0_wp, 1.0e-7_wp, 'plates, largest error of 15 m/s')
    end do
  end subroutine plates

  !> The parabola at the wall adds a smaller term of third order, so the order 2 is approached from below.
  subroutine duct()
    real(wp) :: error(3)
    integer :: level
    logical :: ok

    do level = 1, 3
      call duct_error(comm, 8*2**level, error(level), ok)
      if (comm%is_root()) call expect(ok, 'duct converges')
    end do
    if (.not. comm%is_root()) return
    call expect(log(error(2)/error(3))/log(2.0_wp) > 1.85_wp, 'duct: second order')
    call expect(error(3) < 2.0e-4_wp*duct_velocity(0.0_wp, 0.0_wp), 'duct: 0.02 % on 64 cells')
  end subroutine duct

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
    scene%settings%pressure_drop = 0.0_wp
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

end program test_gas_channel
