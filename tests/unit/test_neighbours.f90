!> The list of pairs of wide size distributions is the one found by looking at all pairs.
program test_neighbours
  use check, only: expect_all, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put
  use kinds, only: wp
  use outcome, only: outcome_t
  use random_numbers, only: random_t, new_random
  use solids, only: solids_t
  implicit none

  integer, parameter :: n = 600
  real(wp), parameter :: largest = 1.0e-3_wp, extent(3) = [0.0045_wp, 0.005_wp, 0.009_wp]  ! [m]
  logical, parameter :: walls(3) = .false.
  type(communicator_t) :: comm

  call start_ranks(comm)
  call clouds(1.0_wp, 'one size')
  call clouds(1.5_wp, '1:1.5')
  call clouds(3.0_wp, '1:3')
  call clouds(10.0_wp, '1:10')
  call clouds(30.0_wp, '1:30')
  call clouds(1000.0_wp, '1:1000')
  call at_the_limit(walls, 'between walls')
  call at_the_limit([.true., .true., .true.], 'with periodic faces all round')
  call late_giant()
  if (comm%is_root()) call finish()
  call stop_ranks()

contains

  !> Clouds of sizes up to `ratio` apart, between walls and periodic faces, mixed and apart.
  subroutine clouds(ratio, name)
    real(wp), intent(in) :: ratio
    character(len=*), intent(in) :: name

    call compare(ratio, walls, .false., name//' between walls')
    call compare(ratio, [.true., .false., .false.], .false., name//' with one periodic direction')
    call compare(ratio, [.true., .true., .true.], .false., name//' with periodic faces all round')
    call compare(ratio, walls, .true., name//' with the small far above the large')
    call compare(ratio, [.true., .true., .false.], .true., name//' the same with periodic sides')
  end subroutine clouds

  function material() result(contact)
    type(contact_settings_t) :: contact

    contact%stiffness = 200.0_wp
    contact%friction = 0.3_wp
  end function material

  subroutine compare(ratio, periodic, apart, name)
    real(wp), intent(in) :: ratio
    logical, intent(in) :: periodic(3), apart
    character(len=*), intent(in) :: name

    type(solids_t) :: solids
    type(outcome_t) :: outcome
    real(wp) :: x(3, n), diameter(n)
    integer, allocatable :: before(:)

    call draw(ratio, apart, x, diameter)
    solids = scene(comm, extent, 0.0_wp, material(), periodic)
    call put(solids, x, 0*x, diameter)
    call expect_all(in_order(solids), 'partners are own parcels behind, then ghosts: '//name)
    call expect_all(all(seen(solids) == near(x, diameter, solids%skin, periodic)), &
                    'the pairs listed are those near: '//name)
    call solids%renew_lists(outcome)
    if (ratio < 4) call expect_all(all(seen(solids) == near(x, diameter, solids%skin, periodic)), 'with another skin: '//name)
    allocate (before(solids%list%entries), source=solids%list%partner(1:solids%list%entries))
    solids%numerics%skin = solids%skin
    call solids%renew_lists(outcome)
    call expect_all(size(before) == solids%list%entries, 'lists made twice are the same: '//name)
    if (size(before) /= solids%list%entries) return
    call expect_all(all(before == solids%list%partner(1:size(before))), 'in the same order: '//name)
  end subroutine compare

  !> Random places, which may overlap, and sizes that are evenly spread in their logarithm, more of the small.
  !> Apart: the higher, the smaller, and a gap between.
  subroutine draw(ratio, apart, x, diameter)
    real(wp), intent(in) :: ratio
    logical, intent(in) :: apart
    real(wp), intent(out) :: x(3, n), diameter(n)

    type(random_t) :: random
    integer :: i, a

    random = new_random(7, 1)
    do i = 1, n
      diameter(i) = largest*ratio**(-sqrt(random%uniform()))
      do a = 1, 3
        x(a, i) = extent(a)*random%uniform()
      end do
      if (apart) x(3, i) = merge(0.9_wp + 0.1_wp*random%uniform(), 0.5_wp*random%uniform(), i > n/2)*extent(3)
    end do
    diameter(1:2) = [largest, largest/ratio]
    if (apart) call sort_up(diameter)
    diameter = diameter(n:1:-1)
  end subroutine draw

  pure subroutine sort_up(values)
    real(wp), intent(inout) :: values(:)

    integer :: i, k
    real(wp) :: least

    do i = 1, size(values)
      k = i - 1 + minloc(values(i:), 1)
      least = values(k)
      values(k) = values(i)
      values(i) = least
    end do
  end subroutine sort_up

  !> How often each parcel sees each other: once if they are near. Pairs of one rank are listed once and count
  !> for both; pairs with a ghost are listed on either side.
  function seen(solids)
    type(solids_t), intent(in) :: solids
    integer :: seen(n, n)

    real(wp), allocatable :: counts(:,:)
    integer :: i, k, a, b

    allocate (counts(n, n), source=0.0_wp)
    do i = 1, solids%parcels%n
      a = int(solids%parcels%id(i))
      do k = solids%list%first(i), solids%list%first(i + 1) - 1
        b = int(solids%parcels%id(solids%list%partner(k)))
        counts(a, b) = counts(a, b) + 1
        if (solids%list%partner(k) <= solids%parcels%n) counts(b, a) = counts(b, a) + 1
      end do
    end do
    do i = 1, n
      seen(:, i) = nint(comm%sum(counts(:, i)))
    end do
  end function seen

  !> The same by looking at all pairs: 1 where they are closer than radii and skin, directly or across faces.
  pure function near(x, diameter, skin, periodic)
    real(wp), intent(in) :: x(3, n), diameter(n), skin  !< [m]
    logical, intent(in) :: periodic(3)
    integer :: near(n, n)

    real(wp) :: way(3)
    integer :: i, j

    near = 0
    do j = 1, n
      do i = 1, n
        way = abs(x(:, i) - x(:, j))
        where (periodic) way = min(way, extent - way)
        if (i /= j .and. norm2(way) < 0.5_wp*(diameter(i) + diameter(j)) + skin) near(i, j) = 1
      end do
    end do
  end function near

  !> Whether each row has own parcels of higher columns, then ghosts, and each entry knows its row.
  pure function in_order(solids)
    type(solids_t), intent(in) :: solids
    logical :: in_order

    integer :: i, k

    in_order = solids%list%rows == solids%parcels%n
    if (solids%parcels%n > 0) in_order = in_order .and. solids%list%first(solids%parcels%n + 1) == solids%list%entries + 1
    do i = 1, solids%parcels%n
      do k = solids%list%first(i), solids%list%first(i + 1) - 1
        in_order = in_order .and. solids%list%partner(k) > i .and. solids%list%row(k) == i
        if (k == solids%list%first(i)) cycle
        if (solids%list%partner(k) <= solids%parcels%n) then
          in_order = in_order .and. solids%list%partner(k - 1) <= solids%parcels%n
        end if
      end do
    end do
  end function in_order

  !> Pairs of the largest of each level along an axis, as far apart as a listed pair may be, a hair less or a hair more.
  subroutine at_the_limit(periodic, name)
    logical, intent(in) :: periodic(3)
    character(len=*), intent(in) :: name

    real(wp), parameter :: skin = 0.06e-3_wp, hair(2) = [-1.0e-6_wp, 1.0e-6_wp]
    type(solids_t) :: solids
    type(random_t) :: random
    real(wp) :: x(3, n), diameter(n), way(3), gap
    integer :: i, a, scenes

    random = new_random(8, 1)
    do scenes = 1, 4
      do i = 1, n
        diameter(i) = largest/2**min(3, int(4*random%uniform()))
        do a = 1, 3
          x(a, i) = extent(a)*random%uniform()
        end do
      end do
      do i = 2, n, 2
        way = 0.0_wp
        a = 1 + min(2, int(3*random%uniform()))
        gap = 0.5_wp*(diameter(i - 1) + diameter(i)) + skin*(1 + hair(1 + modulo(i/2, 2)))
        way(a) = sign(gap, random%uniform() - 0.5_wp)
        if (abs(x(a, i - 1) + way(a) - 0.5_wp*extent(a)) > 0.5_wp*extent(a) .and. .not. periodic(a)) way = -way
        x(:, i) = x(:, i - 1) + way
        where (periodic) x(:, i) = modulo(x(:, i), extent)
      end do
      solids = scene(comm, extent, 0.0_wp, material(), periodic)
      solids%numerics%skin = skin
      call put(solids, x, 0*x, diameter)
      call expect_all(all(seen(solids) == near(x, diameter, skin, periodic)), 'pairs at the limit are told apart '//name)
    end do
  end subroutine at_the_limit

  !> One that is much larger than all before it is seen by them.
  subroutine late_giant()
    type(solids_t) :: solids
    real(wp) :: x(3, n), diameter(n)

    call draw(2.0_wp, .false., x, diameter)
    x(:, n) = 0.5_wp*extent
    diameter = diameter/10
    diameter(n) = largest
    solids = scene(comm, extent, 0.0_wp, material(), [.true., .false., .true.])
    call put(solids, x(:, 1:n - 1), 0*x(:, 1:n - 1), diameter(1:n - 1))
    call put(solids, x(:, n:n), 0*x(:, n:n), diameter(n:n))
    call expect_all(all(seen(solids) == near(x, diameter, solids%skin, [.true., .false., .true.])), &
                    'a large parcel that comes late is seen')
  end subroutine late_giant

end program test_neighbours
