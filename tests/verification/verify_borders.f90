!> Contacts across the border of two ranks against the same on one.
! ranks: 2
program verify_borders
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use check, only: expect, finish
  use contact_settings, only: contact_settings_t
  use des_scenes, only: place_of, put, run, scene
  use kinds, only: wp
  use mpi_f08, only: MPI_COMM_SELF
  use report, only: check_value
  use solids, only: solids_t
  implicit none

  integer, parameter :: side = 9, pairs = side**3
  real(wp), parameter :: pitch = 4.0e-3_wp
  type(communicator_t) :: comm, alone

  call start_ranks(comm)
  alone%handle = MPI_COMM_SELF
  call across_border('linear')
  call across_border('hertz')
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> A lattice of pairs that meet obliquely, each in a direction of its own, many with their parcels on two ranks: the
  !> largest difference of velocities and spins from those of one rank [m/s].
  subroutine across_border(law)
    character(len=*), intent(in) :: law

    type(contact_settings_t) :: contact
    type(solids_t) :: together, single
    real(wp) :: x(3, 2*pairs), v(3, 2*pairs), d(2*pairs), across, worst
    real(wp), allocatable :: shared(:,:), whole(:,:)
    integer :: i

    contact%law = law
    contact%stiffness = 500.0_wp
    contact%youngs_modulus = 1.0e7_wp
    contact%poisson_ratio = 0.3_wp
    contact%friction = 0.4_wp
    do i = 1, pairs
      call pair(i, x(:, 2*i - 1:2*i), v(:, 2*i - 1:2*i))
    end do
    d = 1.0e-3_wp
    allocate (shared(6, 2*pairs), whole(6, 2*pairs))
    together = scene(comm, [side, side, side]*pitch, 0.0_wp, contact)
    single = scene(alone, [side, side, side]*pitch, 0.0_wp, contact)
    call put(together, x, v, d)
    call put(single, x, v, d)
    across = split_pairs(together)
    call run(together, 300, single%time_step_limit())
    call run(single, 300, single%time_step_limit())
    call gather(together, shared)
    call gather(single, whole)
    worst = maxval(abs(shared - whole))
    if (.not. comm%is_root()) return
    call expect(across >= side, 'pairs lie on two ranks')
    call expect(all(sum(whole(4:6, :)**2, 1) > 0), 'every pair has met')
    call check_value('border_'//law, worst, 0.0_wp)
  end subroutine across_border

  !> Pair i near its place in the lattice, as tiles may lie like the lattice, 0.1 mm apart; it comes together at 1 m/s.
  pure subroutine pair(i, x, v)
    integer, intent(in) :: i
    real(wp), intent(out) :: x(3, 2), v(3, 2)

    real(wp) :: along(3), aside(3), middle(3)

    along = [sin(1.7_wp*i), cos(2.9_wp*i), sin(0.6_wp*i + 1)]
    along = along/norm2(along)
    aside = [along(2), -along(1), 0.0_wp]
    middle = pitch*([modulo(i - 1, side), modulo((i - 1)/side, side), (i - 1)/side**2] + 0.5_wp &
                    + 0.15_wp*sin(i*[1.1_wp, 2.3_wp, 3.7_wp]))
    x(:, 1) = middle - 0.55e-3_wp*along
    x(:, 2) = middle + 0.55e-3_wp*along
    v(:, 1) = 0.5_wp*along + 0.2_wp*aside
    v(:, 2) = -v(:, 1)
  end subroutine pair

  !> Pairs whose parcels are on two ranks.
  function split_pairs(solids) result(count)
    type(solids_t), intent(in) :: solids
    real(wp) :: count

    integer :: i

    count = 0
    do i = 1, pairs
      if ((place_of(solids, 2*i - 1) > 0) .neqv. (place_of(solids, 2*i) > 0)) count = count + 1
    end do
  end function split_pairs

  !> Velocities and spins by number, on all ranks.
  subroutine gather(solids, rows)
    type(solids_t), intent(in) :: solids
    real(wp), intent(out) :: rows(:,:)  !< (6, 2 pairs) [m/s]

    integer :: i

    rows = 0
    do i = 1, solids%parcels%n
      rows(:, solids%parcels%id(i)) = solids%parcels%state([5, 6, 7, 9, 10, 11], i)
    end do
    do i = 1, size(rows, 1)
      rows(i, :) = solids%comm%sum(rows(i, :))
    end do
  end subroutine gather

end program verify_borders
