!> The step of the gas as a whole: bounds, ranks, two dimensions, failure, restart, backflow, mistakes.
program test_gas_step
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use convection, only: limited, limiter_index
  use gas, only: gas_t, saved_fields, pace_size
  use gas_cases, only: scene_t, record, make_gas, set_cells, steps, &
    flat_void, flat_drag, slug_drag, slug_source
  use kinds, only: wp
  use mpi_f08, only: MPI_COMM_SELF
  use outcome, only: outcome_t
  implicit none

  real(wp), parameter :: o = 0.0_wp, edge = 4.0e-3_wp
  type(communicator_t) :: comm

  call start_ranks(comm)
  call interpolations()
  call carried_step()
  call any_ranks([8, 20, 6], [.false., .false., .false.], 'a bed')
  call any_ranks([8, 20, 6], [.true., .false., .true.], 'a periodic bed')
  call any_ranks([9, 21, 5], [.true., .false., .false.], 'an odd bed')
  call flat_and_thick()
  call failed_step()
  call continued_run()
  call falling_gas()
  call mistakes()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> A box with inflow below and outflow above; the other sides are walls.
  function vessel(cells, periodic) result(scene)
    integer, intent(in) :: cells(3)
    logical, intent(in) :: periodic(3)
    type(scene_t) :: scene

    scene%cells = cells
    scene%periodic = periodic
    scene%upper = cells*edge
    scene%gravity = [o, -9.81_wp, o]
    allocate (scene%records(2))
    associate (top => scene%upper)
      scene%records(1) = record('bottom', 'inflow', [o, o, o], [top(1), o, top(3)], velocity=0.45_wp)
      scene%records(2) = record('top', 'outflow', [o, top(2), o], top)
    end associate
  end function vessel

  !> Void fraction and drag of a bed with lumps that move with the step.
  subroutine set_bed(gas, step)
    type(gas_t), intent(inout) :: gas
    integer, intent(in) :: step

    integer :: i, j, k
    real(wp) :: x(3), solids

    do k = 1, gas%boxes%n(3)
      do j = 1, gas%boxes%n(2)
        do i = 1, gas%boxes%n(1)
          x = gas%boxes%lo + [i, j, k] - 1
          solids = 0.3_wp*(1 + sin(0.9_wp*x(1) + 0.1_wp*step)*cos(0.7_wp*x(2) - 0.2_wp*step)*sin(1.1_wp*x(3)))
          if (x(2) > 12) solids = 0.01_wp
          gas%eps(i, j, k) = 1 - solids
          gas%drag(i, j, k) = 3.0e-3_wp*solids**2
          gas%drag_source(:, i, j, k) = gas%drag(i, j, k)*[0.3_wp*sin(x(2)), 0.2_wp*cos(x(1)), 0.3_wp*sin(x(1) + x(3))]
        end do
      end do
    end do
  end subroutine set_bed

  !> What is added to the value of the cell upwind makes a straight line exact on the face; by quick a parabola, too.
  subroutine interpolations()
    character(len=8), parameter :: limiters(5) = ['minmod  ', 'van_leer', 'superbee', 'central ', 'quick   ']
    real(wp) :: found(2)
    integer :: m

    do m = 1, size(limiters)
      ! phi = x and phi = x (x + 4) at x = -3/2, -1/2 and 1/2, the face at 0
      call limited(limiter_index(trim(limiters(m))), 2, [1.0_wp, 2.0_wp], [1.0_wp, 4.0_wp], found)
      if (.not. comm%is_root()) cycle
      call expect_close(found(1), 0.5_wp, 1.0e-14_wp, 'a line is exact: '//limiters(m))
      if (limiters(m) == 'quick') call expect_close(found(2), 1.75_wp, 1.0e-14_wp, 'a parabola is exact')
      if (limiters(m) == 'central') call expect_close(found(2), 2.0_wp, 1.0e-14_wp, 'the mean of both cells')
    end do
  end subroutine interpolations

  !> A jump of the velocity across the flow that carries it stays between its two values and moves at the flow's speed;
  !> second-order limiters keep it sharper than upwind does.
  subroutine carried_step()
    character(len=8), parameter :: limiters(4) = ['upwind  ', 'minmod  ', 'van_leer', 'superbee']
    integer, parameter :: n = 40
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: low, high, energy(4)
    integer :: j, m
    logical :: ok

    scene%cells = [2, n, 1]
    scene%upper = scene%cells*edge
    scene%periodic = [.true., .true., .true.]
    scene%settings%viscosity = 0.0_wp
    scene%settings%velocity = [o, 1.0_wp, o]
    scene%numerics%velocity_tolerance = 1.0e-10_wp
    allocate (scene%records(0))
    do m = 1, 4
      scene%numerics%limiter = limiters(m)
      call make_gas(comm, scene, gas, outcome)
      do j = 1, gas%boxes%n(2)
        gas%velocity(:, j, :, 1) = merge(1.0_wp, 0.0_wp, abs(gas%boxes%lo(2) + j - 1 - 15) <= 6)
      end do
      ok = steps(gas, 40, 0.05_wp*edge)
      associate (u => gas%velocity(1, 1:gas%boxes%n(2), 1, 1))
        low = comm%min(minval(u))
        high = comm%max(maxval(u))
        energy(m) = comm%sum(sum(u**2))
        if (comm%is_root()) call expect(ok .and. low > -1.0e-7_wp .and. high < 1 + 1.0e-7_wp, 'bounded: '//limiters(m))
        low = comm%sum(sum(u))
        if (comm%is_root()) call expect_close(low, 13.0_wp, 1.0e-8_wp, 'momentum is carried, not made')
      end associate
      call gas%destroy()
    end do
    if (comm%is_root()) call expect(all(energy(2:) > energy(:3)), 'each limiter sharper than the one before')
  end subroutine carried_step

  !> Each rank compares its box with a run of the whole grid of its own.
  subroutine any_ranks(cells, periodic, name)
    integer, intent(in) :: cells(3)
    logical, intent(in) :: periodic(3)
    character(len=*), intent(in) :: name

    type(communicator_t) :: alone
    type(scene_t) :: scene
    type(gas_t) :: shared, whole
    type(outcome_t) :: outcome
    real(wp) :: difference(2)
    integer :: step
    logical :: converged(2)

    alone%handle = MPI_COMM_SELF
    scene = vessel(cells, periodic)
    scene%numerics%tolerance = 1.0e-10_wp
    scene%numerics%velocity_tolerance = 1.0e-12_wp
    call make_gas(comm, scene, shared, outcome)
    call make_gas(alone, scene, whole, outcome)
    do step = 0, 3
      call set_bed(shared, step)
      call set_bed(whole, step)
      if (step > 0) then
        call shared%advance(1.0e-3_wp, converged(1))
        call whole%advance(1.0e-3_wp, converged(2))
        if (comm%is_root()) call expect(all(converged), name//' converges')
      end if
      call shared%accept()
      call whole%accept()
    end do
    associate (lo => shared%boxes%lo, hi => shared%boxes%hi, n => shared%boxes%n)
      difference(1) = maxval(abs(shared%velocity(1:n(1), 1:n(2), 1:n(3), :) &
                                 - whole%velocity(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3), :)))/maxval(abs(whole%velocity))
      difference(2) = maxval(abs(shared%pressure(1:n(1), 1:n(2), 1:n(3)) &
                                 - whole%pressure(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3))))/maxval(abs(whole%pressure))
    end associate
    difference = comm%max(difference)
    if (comm%is_root()) then
      call expect_close(difference(1), o, 1.0e-10_wp, name//', velocity on any ranks')
      call expect_close(difference(2), o, 1.0e-10_wp, name//', pressure on any ranks')
    end if
    call shared%destroy()
    call whole%destroy()
  end subroutine any_ranks

  !> Two dimensions, one cell between slip faces or one periodic cell, are three with nothing happening in the third.
  subroutine flat_and_thick()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp) :: profile(8, 24, 3)
    integer :: m, step
    logical :: ok, converged

    ok = .true.
    do m = 1, 3
      scene = vessel([8, 24, merge(4, 1, m == 3)], [.false., .false., m == 2])
      scene%numerics%tolerance = 1.0e-10_wp
      scene%numerics%velocity_tolerance = 1.0e-11_wp
      if (m /= 2) then
        scene%records = [scene%records(1:2), record('front', 'slip', [o, o, o], [scene%upper(1:2), o]), &
                         record('back', 'slip', [o, o, scene%upper(3)], scene%upper)]
      end if
      call make_gas(comm, scene, gas, outcome)
      do step = 0, 3
        call set_cells(gas%boxes, flat_void, gas%eps)
        call set_cells(gas%boxes, flat_drag, gas%drag)
        if (step > 0) call gas%advance(1.0e-3_wp, converged)
        if (step > 0) ok = ok .and. converged
        call gas%accept()
      end do
      profile(:, :, m) = o
      associate (lo => gas%boxes%lo, hi => gas%boxes%hi, n => gas%boxes%n)
        if (lo(3) == 1) profile(lo(1):hi(1), lo(2):hi(2), m) = gas%velocity(1:n(1), 1:n(2), 1, 2)
      end associate
      call gas%destroy()
    end do
    do m = 1, 3
      profile(:, :, m) = reshape(comm%sum(reshape(profile(:, :, m), [8*24])), [8, 24])
    end do
    if (.not. comm%is_root()) return
    call expect(ok, 'flat and thick converge')
    call expect_close(maxval(abs(profile(:, :, 1) - profile(:, :, 3))), o, 1.0e-8_wp, 'two dimensions: slip')
    call expect_close(maxval(abs(profile(:, :, 2) - profile(:, :, 3))), o, 1.0e-8_wp, 'two dimensions: periodic')
  end subroutine flat_and_thick

  !> Too few iterations, or an input that is not a number: no convergence, and nothing has changed, layers around the box
  !> included; the next step is that of a gas which has never tried.
  subroutine failed_step()
    type(scene_t) :: scene
    type(gas_t) :: gas, fresh
    logical :: converged, same
    integer :: m

    scene = vessel([8, 20, 4], [.true., .false., .false.])
    scene%settings%flow_given = .true.
    scene%settings%mass_flow = [1.0e-4_wp, o, o]
    scene%numerics%maximum_iterations = 20
    call start_bed(scene, gas)
    call start_bed(scene, fresh)
    same = identical(gas, fresh)
    if (comm%is_root()) call expect(same .and. abs(gas%driving%drop(1)) > o, 'two gases to start from')
    do m = 1, 3
      call set_bed(gas, 5)
      gas%numerics%maximum_iterations = merge(1, 4, m == 1)
      gas%numerics%velocity_tolerance = merge(1.0e-15_wp, 1.0e-4_wp, m == 2)
      if (m == 3) gas%eps(1, 1, 1) = not_a_number()
      call gas%advance(1.0e-3_wp, converged)
      same = identical(gas, fresh)
      if (comm%is_root()) call expect(same .and. .not. converged, 'a failed step leaves no trace')
    end do
    gas%numerics = scene%numerics
    call set_bed(gas, 1)
    call set_bed(fresh, 1)
    call gas%advance(5.0e-4_wp, converged)
    if (comm%is_root()) call expect(converged, 'and the next one works')
    call fresh%advance(5.0e-4_wp, converged)
    same = identical(gas, fresh)
    if (comm%is_root()) call expect(same, 'as if none had failed')
    call gas%destroy()
    call fresh%destroy()
  end subroutine failed_step

  !> A gas in a bed, after one step.
  subroutine start_bed(scene, gas)
    type(scene_t), intent(in) :: scene
    type(gas_t), intent(out) :: gas

    type(outcome_t) :: outcome
    logical :: converged

    call make_gas(comm, scene, gas, outcome)
    call set_bed(gas, 0)
    call gas%accept()
    call gas%advance(1.0e-3_wp, converged)
    call gas%accept()
    if (.not. converged) error stop 'test_gas_step: no step to start from'
  end subroutine start_bed

  !> To the last bit, on all ranks: all that a step starts from but its inputs.
  function identical(one, two)
    type(gas_t), intent(in) :: one, two
    logical :: identical

    identical = .not. comm%any_of(any(abs(one%velocity - two%velocity) > o) .or. any(abs(one%pressure - two%pressure) > o) &
                                  .or. any(abs(one%eps_old - two%eps_old) > o) &
                                  .or. any(abs(one%driving%drop - two%driving%drop) > o))
  end function identical

  function not_a_number() result(x)
    use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
    real(wp) :: x

    x = ieee_value(x, ieee_quiet_nan)
  end function not_a_number

  !> Bit for bit what the run would have been.
  subroutine continued_run()
    type(scene_t) :: scene
    type(gas_t) :: run, continued
    type(outcome_t) :: outcome
    real(wp), allocatable :: saved(:,:,:,:), one(:,:,:,:), two(:,:,:,:)
    real(wp) :: pace(pace_size)
    logical :: converged, same
    integer :: step

    scene = vessel([8, 20, 4], [.true., .false., .false.])
    ! a second opening, in the bottom
    scene%records(1)%upper(1) = scene%upper(1)/2
    scene%records = [scene%records, record('leak', 'outflow', [0.75_wp*scene%upper(1), o, o], [scene%upper(1), o, scene%upper(3)])]
    call make_gas(comm, scene, run, outcome)
    call make_gas(comm, scene, continued, outcome)
    associate (n => run%boxes%n)
      allocate (saved(saved_fields, n(1), n(2), n(3)))
      allocate (one, two, mold=saved)
    end associate
    do step = 0, 6
      call set_bed(run, step)
      if (step > 0) call run%advance(1.0e-3_wp, converged)
      call run%accept()
      if (step == 3) call run%export_state(saved, pace)
    end do
    call continued%import_state(saved, pace)
    do step = 4, 6
      call set_bed(continued, step)
      call continued%advance(1.0e-3_wp, converged)
      call continued%accept()
    end do
    call run%export_state(one, pace)
    call continued%export_state(two, pace)
    same = .not. comm%any_of(any(abs(one - two) > o))
    if (comm%is_root()) call expect(same .and. converged, 'a continued run is the same to the last bit')
    call run%destroy()
    call continued%destroy()
  end subroutine continued_run

  !> Heavy slugs fall from the open end and drag gas in with them: the step converges and the gas does not run away.
  subroutine falling_gas()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome
    real(wp), allocatable :: field(:,:,:)
    real(wp) :: fastest
    integer :: step
    logical :: ok, converged

    scene = vessel([8, 20, 4], [.false., .false., .false.])
    call make_gas(comm, scene, gas, outcome)
    ok = .true.
    call set_bed(gas, 0)
    call gas%accept()
    call set_cells(gas%boxes, slug_drag, gas%drag)
    allocate (field, source=gas%drag)
    call set_cells(gas%boxes, slug_source, field)
    gas%drag_source(2, :, :, :) = field
    do step = 1, 60
      call gas%advance(2.0e-3_wp, converged)
      call gas%accept()
      ok = ok .and. converged
    end do
    fastest = comm%max(maxval(abs(gas%velocity)))
    if (comm%is_root()) then
      call expect(ok, 'backflow converges')
      call expect(fastest < 6.0_wp, 'backflow stays bounded')
    end if
    call gas%destroy()
  end subroutine falling_gas

  !> What only the grid shows.
  subroutine mistakes()
    type(scene_t) :: scene
    type(gas_t) :: gas
    type(outcome_t) :: outcome(3)

    scene = vessel([8, 20, 4], [.false., .false., .false.])
    scene%records(2)%lower(2) = 0.9_wp*scene%upper(2)
    scene%records(2)%upper(2) = 0.95_wp*scene%upper(2)
    scene%records(2)%lower(1) = 0.4_wp*scene%upper(1)
    scene%records(2)%upper(1) = 0.6_wp*scene%upper(1)
    scene%records(2)%lower(3) = 0.4_wp*scene%upper(3)
    scene%records(2)%upper(3) = 0.6_wp*scene%upper(3)
    call make_gas(comm, scene, gas, outcome(1))
    scene = vessel([8, 20, 4], [.false., .false., .false.])
    scene%records = [scene%records, record('jet', 'inflow', [o, o, o], [edge, o, edge], velocity=1.0_wp)]
    call make_gas(comm, scene, gas, outcome(2))
    scene = vessel([8, 20, 4], [.false., .false., .false.])
    scene%records = scene%records(1:1)
    call make_gas(comm, scene, gas, outcome(3))
    if (.not. comm%is_root()) return
    call expect(outcome(1)%failed(), 'a region on no face: '//outcome(1)%message)
    call expect(outcome(2)%failed(), 'two regions on one face: '//outcome(2)%message)
    call expect(outcome(3)%failed(), 'no way out: '//outcome(3)%message)
  end subroutine mistakes

end program test_gas_step
