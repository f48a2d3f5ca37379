!> Many parcels of three materials, which differ in springs, friction, rolling and attraction: ranks and periodic faces make no
!> difference, a restart none, the order of materials none.
program test_materials_many
  use check, only: expect_all, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put, cloud, run
  use kinds, only: wp
  use material_settings, only: material_settings_t, pair_settings_t
  use mpi_f08, only: MPI_COMM_SELF
  use outcome, only: outcome_t
  use solids, only: solids_t
  use solids_state, only: solids_state_t, export_state, import_state
  implicit none

  integer, parameter :: n = 400
  type(communicator_t) :: comm, alone

  call start_ranks(comm)
  alone%handle = MPI_COMM_SELF
  call same_on_all_ranks(three(0.3_wp, [1, 2, 3]))
  call same_on_all_ranks(three(0.0_wp, [1, 2, 3]))
  call same_on_all_ranks(without_attraction(three(0.3_wp, [1, 2, 3])))
  call restart(0.3_wp)
  call restart(0.0_wp)
  call any_order()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> Three materials in a given order, one powder of each; the third attracts nothing but the first.
  function three(friction, order) result(contact)
    real(wp), intent(in) :: friction
    integer, intent(in) :: order(3)
    type(contact_settings_t) :: contact

    type(material_settings_t) :: materials(3)
    integer :: place(3), m

    if (friction > 0) contact%rolling = 'spring'
    contact%cohesion = 'van_der_waals'
    contact%minimum_separation = 1.0e-7_wp
    contact%maximum_separation = 1.0e-5_wp
    materials = [material_settings_t(stiffness=200.0_wp, restitution=0.9_wp, friction=friction, rolling_friction=0.1_wp, &
                                     rolling_damping=0.2_wp, hamaker_constant=3.0e-15_wp), &
                 material_settings_t(stiffness=500.0_wp, restitution=0.4_wp, friction=2*friction, rolling_friction=0.3_wp, &
                                     hamaker_constant=1.0e-14_wp), &
                 material_settings_t(stiffness=300.0_wp, restitution=0.7_wp, friction=0.0_wp, rolling_friction=0.0_wp, &
                                     hamaker_constant=0.0_wp)]
    allocate (contact%materials(3))
    do m = 1, 3
      contact%materials(m) = materials(order(m))
      place(order(m)) = m
    end do
    allocate (contact%pairs(1))
    contact%pairs(1) = pair_settings_t(materials=[place(3), place(1)], restitution=0.5_wp, friction=friction/2, &
                                       rolling_friction=0.2_wp, hamaker_constant=5.0e-15_wp)
    allocate (contact%powder_material, source=place)
  end function three

  !> Of ghosts only those that may touch are kept up to date.
  function without_attraction(contact) result(plain)
    type(contact_settings_t), intent(in) :: contact
    type(contact_settings_t) :: plain

    plain = contact
    plain%cohesion = 'none'
  end function without_attraction

  !> A cloud of three powders, of different densities, that falls into a corner of its chamber.
  subroutine falling(ranks, contact, solids)
    type(communicator_t), intent(in) :: ranks
    type(contact_settings_t), intent(in) :: contact
    type(solids_t), intent(out) :: solids

    real(wp), allocatable :: x(:,:), v(:,:), diameter(:)
    real(wp), parameter :: density(3) = [2500.0_wp, 8000.0_wp, 1200.0_wp]
    integer :: powder(n), i

    call cloud(n, [0.0_wp, 0.0_wp, 0.0_wp], 1.25e-3_wp, [8, 6], x, v, diameter)
    do i = 1, n
      powder(i) = 1 + modulo(i/2, 3)
    end do
    solids = scene(ranks, [0.01_wp, 0.0075_wp, 0.02_wp], -9.81_wp, contact, [.true., .false., .false.])
    call put(solids, x, v, diameter, density=density(powder), powder=powder)
  end subroutine falling

  !> Positions, brought inside, and velocities of all parcels by id, on all ranks.
  subroutine gather(solids, every)
    type(solids_t), intent(in) :: solids
    real(wp), intent(out) :: every(6, n)

    real(wp) :: x(3)
    integer :: i

    every = 0.0_wp
    do i = 1, solids%parcels%n
      x = solids%parcels%state(1:3, i)
      call solids%tiles%wrap(x)
      every(1:3, solids%parcels%id(i)) = x
      every(4:6, solids%parcels%id(i)) = solids%parcels%state(5:7, i)
    end do
    do i = 1, 6
      every(i, :) = solids%comm%sum(every(i, :))
    end do
  end subroutine gather

  !> All ranks together and each by itself compute the same fall.
  subroutine same_on_all_ranks(contact)
    type(contact_settings_t), intent(in) :: contact

    type(solids_t) :: together, apart
    real(wp) :: a(6, n), b(6, n)
    integer :: i

    call falling(comm, contact, together)
    call falling(alone, contact, apart)
    call expect_all(size(apart%parts) == 6, 'every pair of materials has its own part of the list')
    do i = 1, 10
      call run(together, 50, apart%time_step_limit())
      call run(apart, 50, apart%time_step_limit())
    end do
    call gather(together, a)
    call gather(apart, b)
    call expect_all(together%tilings > 1 .or. comm%size == 1, 'tiles change hands when the load is uneven')
    call expect_all(apart%rebuilds > 2 .and. all(apart%parts%list%entries > 20), 'and all pairs are met')
    call expect_all(all(abs(a(1:3, :) - b(1:3, :)) < 1.0e-10_wp*0.01_wp), 'positions do not depend on the ranks')
    call expect_all(all(abs(a(4:6, :) - b(4:6, :)) < 1.0e-10_wp*0.5_wp), 'nor velocities')
    call expect_all(.not. abs(together%time_step_limit() - apart%time_step_limit()) > 0.0_wp, 'nor the step')
  end subroutine same_on_all_ranks

  !> A run taken up from its exported state is the uninterrupted run, bit for bit.
  subroutine restart(friction)
    real(wp), intent(in) :: friction

    type(solids_t) :: whole, resumed
    type(solids_state_t) :: state
    type(outcome_t) :: outcome
    real(wp) :: dt

    call falling(comm, three(friction, [1, 2, 3]), whole)
    dt = whole%time_step_limit()
    call run(whole, 517, dt)
    call export_state(whole, state)
    resumed = scene(comm, [0.01_wp, 0.0075_wp, 0.02_wp], -9.81_wp, three(friction, [1, 2, 3]), [.true., .false., .false.])
    call import_state(resumed, state, outcome)
    call expect_all(.not. outcome%failed(), 'a state is taken up')
    call expect_all(.not. abs(resumed%time_step_limit() - dt) > 0.0_wp, 'with the same step')
    call run(whole, 300, dt)
    call run(resumed, 300, dt)
    call expect_all(whole%parcels%n == resumed%parcels%n .and. whole%rebuilds == resumed%rebuilds, &
                    'a resumed run makes the same lists')
    if (whole%parcels%n /= resumed%parcels%n) return
    associate (m => whole%parcels%n)
      call expect_all(.not. any(abs(whole%parcels%state(:, 1:m) - resumed%parcels%state(:, 1:m)) > 0), &
                      'and its state is the same, bit for bit')
    end associate
  end subroutine restart

  !> The order in which materials are declared makes no difference but rounding.
  subroutine any_order()
    type(solids_t) :: one, other
    real(wp) :: a(6, n), b(6, n)

    call falling(comm, three(0.3_wp, [1, 2, 3]), one)
    call falling(comm, three(0.3_wp, [3, 1, 2]), other)
    call expect_all(.not. abs(one%time_step_limit() - other%time_step_limit()) > 1.0e-15_wp*one%time_step_limit(), &
                    'materials in another order have the same step')
    call run(one, 250, one%time_step_limit())
    call run(other, 250, one%time_step_limit())
    call gather(one, a)
    call gather(other, b)
    call expect_all(all(abs(a(1:3, :) - b(1:3, :)) < 1.0e-10_wp*0.01_wp), 'and the same run')
  end subroutine any_order

end program test_materials_many
