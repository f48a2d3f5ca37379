!> Viscosity of eddies smaller than the cells: its size, its stress, flows with it.
program test_gas_eddies
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use eddy_flows, only: channel_error, channel_velocity, pipe_error, shear_force, gap
  use eddy_viscosity, only: add_turned, find_eddies
  use gas, only: gas_t, saved_fields, pace_size
  use gas_settings, only: make_ideal
  use gas_cases, only: scene_t, record, make_gas, set_cells, steps, wavy_void
  use kinds, only: wp
  use mpi_f08, only: MPI_COMM_SELF
  use outcome, only: outcome_t
  use pipe_flow, only: pipe
  implicit none

  real(wp), parameter :: o = 0.0_wp, edge = 4.0e-3_wp
  type(communicator_t) :: comm

  call start_ranks(comm)
  if (comm%size == 1) call flows()  ! on more it is enough that any ranks give the same
  call any_ranks(.false., 'a vessel')
  call any_ranks(.true., 'a pipe of an ideal gas')
  call continued_run()
  call without()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> Those whose velocities are known.
  subroutine flows()
    call channels()
    call shear()
    call pipes()
    call plug()
  end subroutine flows

  !> Between plates: second order, the same along all axes, and of an ideal gas of that density.
  subroutine channels()
    integer, parameter :: axes(2, 5) = reshape([1, 3, 2, 1, 2, 3, 3, 1, 3, 2], [2, 5])
    real(wp) :: error(2), turned
    logical :: ok
    integer :: level, m

    do level = 1, 2
      call channel_error(comm, 1, 2, 8*2**level, error(level), ok)
      if (comm%is_root()) call expect(ok, 'flow between plates converges')
    end do
    if (comm%is_root()) then
      call expect(log(error(1)/error(2))/log(2.0_wp) > 1.7_wp, 'plates: second order, from below')
      call expect_close(error(2)/channel_velocity(gap/2), o, 8.0e-4_wp, 'plates: 0.08 % on 32 cells')
    end if
    do m = 1, 5
      call channel_error(comm, axes(1, m), axes(2, m), 16, turned, ok)
      if (comm%is_root()) call expect(ok, 'so does it along other axes')
      if (comm%is_root()) call expect_close(turned, error(1), 1.0e-8_wp, 'plates across other axes')
    end do
    call channel_error(comm, 1, 2, 16, turned, ok, ideal=.true.)
    if (comm%is_root()) call expect(ok, 'an ideal gas between plates converges')
    if (comm%is_root()) call expect_close(turned, error(1), 1.0e-5_wp, 'an ideal gas between plates')
  end subroutine channels

  !> Between plates that move: a straight line on any cells.
  subroutine shear()
    integer, parameter :: axes(2, 3) = reshape([1, 2, 2, 3, 3, 1], [2, 3])
    real(wp) :: worst, force
    logical :: ok
    integer :: m

    do m = 1, 3
      call shear_force(comm, axes(1, m), axes(2, m), 8, worst, force, ok)
      if (.not. comm%is_root()) cycle
      call expect(ok, 'plates that move converge')
      call expect_close(worst, o, 1.0e-8_wp, 'between them a straight line [m/s]')
      call expect_close(force, 1.0_wp, 1.0e-10_wp, 'and the force of mu + rho l^2 |du/dy|')
    end do
  end subroutine shear

  !> Walls that cut cells.
  subroutine pipes()
    real(wp) :: error(2)
    logical :: ok(2)

    call pipe_error(comm, 8, error(1), ok(1))
    call pipe_error(comm, 16, error(2), ok(2))
    if (.not. comm%is_root()) return
    call expect(all(ok), 'flow in a pipe converges')
    call expect_close(error(2), o, 1.0e-3_wp, 'its error')
    call expect(log(abs(error(1)/error(2)))/log(2.0_wp) > 1.8_wp, 'pipe: second order')
  end subroutine pipes

  !> Between slip walls, from an inflow to an outflow, nothing shears.
  subroutine plug()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: most
    logical :: ok

    scene = vessel(.false.)
    scene%gravity = o
    associate (top => scene%upper)
      scene%records = [record('in', 'inflow', [o, o, o], [top(1), o, top(3)], velocity=2.0_wp), &
                       record('out', 'outflow', [o, top(2), o], top), &
                       record('left', 'slip', [o, o, o], [o, top(2), top(3)]), &
                       record('right', 'slip', [top(1), o, o], top), &
                       record('front', 'slip', [o, o, o], [top(1), top(2), o]), &
                       record('back', 'slip', [o, o, top(3)], top)]
    end associate
    scene%settings%velocity = [o, 2.0_wp, o]
    call make_gas(comm, scene, gas, outcome)
    ok = steps(gas, 3, 1.0e-3_wp)
    most = comm%max(maxval(gas%eddies%eps))
    call gas%destroy()
    if (comm%is_root()) call expect(ok, 'gas between slip walls converges')
    if (comm%is_root()) call expect_close(most, 1.0_wp, 1.0e-6_wp, 'it has no eddies')
  end subroutine plug

  !> Inflow, outflow, walls at rest and moving, slip walls, or a pipe that cuts cells; uneven void fraction.
  function vessel(piped) result(scene)
    logical, intent(in) :: piped
    type(scene_t) :: scene

    scene%cells = [7, 10, 6]
    scene%upper = scene%cells*edge
    scene%gravity = [o, -9.81_wp, o]
    scene%settings%turbulence_model = 'smagorinsky'
    scene%settings%smagorinsky_constant = 0.5_wp
    scene%numerics%tolerance = 1.0e-10_wp
    scene%numerics%velocity_tolerance = 1.0e-12_wp
    scene%numerics%maximum_iterations = 200
    associate (top => scene%upper)
      scene%records = [record('in', 'inflow', [o, o, o], [3*edge, o, top(3)], velocity=2.0_wp), &
                       record('out', 'outflow', [o, top(2), o], top), &
                       record('front', 'slip', [o, o, o], [top(1), top(2), o]), &
                       record('lid', 'no_slip', [top(1), o, o], top)]
      scene%records(4)%wall_velocity = [o, 1.0_wp, -2.0_wp]
      if (.not. piped) return
      scene%records = scene%records(:2)
      scene%records(1)%upper(1) = top(1)
      scene%walls = [pipe(0.5_wp*top + [0.3_wp*edge, o, 0.1_wp*edge], 2, 2.4_wp*edge)]
    end associate
    associate (s => scene%settings)
      s%density_law = 'ideal'
      s%molar_mass = 0.03_wp
      s%temperature = 300.0_wp
      s%reference_pressure = 1.0e5_wp
    end associate
    call make_ideal(scene%settings)
  end function vessel

  !> Each rank compares its box with a run of the whole grid of its own.
  subroutine any_ranks(piped, name)
    logical, intent(in) :: piped
    character(len=*), intent(in) :: name

    type(communicator_t) :: alone
    type(gas_t) :: shared, whole
    type(outcome_t) :: outcome
    real(wp) :: difference(2), most, twice
    logical :: ok(2)

    alone%handle = MPI_COMM_SELF
    call make_gas(comm, vessel(piped), shared, outcome)
    call make_gas(alone, vessel(piped), whole, outcome)
    call set_cells(shared%boxes, wavy_void, shared%eps)
    call set_cells(whole%boxes, wavy_void, whole%eps)
    call shared%accept()
    call whole%accept()
    ok = [steps(shared, 3, 1.0e-3_wp), steps(whole, 3, 1.0e-3_wp)]
    associate (lo => shared%boxes%lo, hi => shared%boxes%hi, n => shared%boxes%n)
      difference(1) = maxval(abs(shared%velocity(1:n(1), 1:n(2), 1:n(3), :) &
                                 - whole%velocity(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3), :)))/maxval(abs(whole%velocity))
      most = maxval(whole%eddies%eps)
      difference(2) = maxval(abs(shared%eddies%eps(1:n(1), 1:n(2), 1:n(3)) &
                                 - whole%eddies%eps(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3))))/most
    end associate
    associate (n => whole%boxes%n)
      associate (eps => whole%eps(1:n(1), 1:n(2), 1:n(3)), eddies => whole%eddies)
        twice = maxval(abs(eps*(whole%viscosity + eddies%viscosity) - whole%viscosity*eddies%eps(1:n(1), 1:n(2), 1:n(3))))
      end associate
    end associate
    difference = comm%max(difference)
    call shared%destroy()
    call whole%destroy()
    if (.not. comm%is_root()) return
    call expect(all(ok), name//' converges')
    call expect(most > 10.0_wp, name//' has eddies')
    call expect_close(twice, o, 1.0e-14_wp*most*1.8e-5_wp, name//', viscosity of eddies joins that of the gas [Pa s]')
    call expect_close(difference(1), o, 1.0e-10_wp, name//', velocity on any ranks')
    call expect_close(difference(2), o, 1.0e-10_wp, name//', viscosity on any ranks')
  end subroutine any_ranks

  !> What is saved of a gas is enough to go on exactly.
  subroutine continued_run()
    type(gas_t) :: gas(2)
    type(outcome_t) :: outcome
    real(wp), allocatable :: fields(:,:,:,:)
    real(wp) :: gap, pace(pace_size)
    logical :: ok(3)

    call make_gas(comm, vessel(.false.), gas(1), outcome)
    call make_gas(comm, vessel(.false.), gas(2), outcome)
    ok(1) = steps(gas(1), 3, 1.0e-3_wp)
    associate (n => gas(1)%boxes%n)
      allocate (fields(saved_fields, n(1), n(2), n(3)))
      call gas(1)%export_state(fields, pace)
      call gas(2)%import_state(fields, pace)
      ok(2) = steps(gas(1), 2, 1.0e-3_wp)
      ok(3) = steps(gas(2), 2, 1.0e-3_wp)
      gap = comm%max(maxval(abs(gas(1)%velocity(1:n(1), 1:n(2), 1:n(3), :) - gas(2)%velocity(1:n(1), 1:n(2), 1:n(3), :))))
    end associate
    call gas(1)%destroy()
    call gas(2)%destroy()
    if (.not. comm%is_root()) return
    call expect(all(ok), 'a continued run converges')
    call expect(.not. gap > o, 'it is the same bit for bit')
  end subroutine continued_run

  !> No memory for eddies that nobody asked for.
  subroutine without()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome

    scene = vessel(.false.)
    scene%settings%turbulence_model = 'none'
    call make_gas(comm, scene, gas, outcome)
    if (comm%is_root()) call expect(.not. allocated(gas%eddies), 'without eddies there is nothing of them')
    call gas%destroy()
  end subroutine without

end program test_gas_eddies
