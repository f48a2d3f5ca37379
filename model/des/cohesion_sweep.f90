!> One more pass over the listed pairs, and over the parcels near walls, for runs with cohesion: it reaches farther than
!> contacts do, and adds its attraction to what they have computed. Pairs of unlike materials come dealt by law: see contact_parts.
module cohesion_sweep
  use chamber, only: chamber_t
  use contact_lanes, only: lanes, full_lanes
  use cohesion, only: cohesion_t, attractions
  use contact_laws, only: contact_laws_t
  use contact_list, only: contact_list_t
  use kinds, only: wp
  use parcels, only: parcels_t, radius_row
  use walls, only: wall_list_t
  implicit none
  private
  public :: attract_pairs, attract_walls

  integer, parameter :: block_pairs = 256  !< listed pairs of a block, which stays in the L1 cache

contains

  !> Add the attraction of all listed pairs within reach, in some rows; they have one law.
  pure subroutine attract_pairs(cohesion, list, rows, parcels)
    type(cohesion_t), intent(in) :: cohesion
    type(contact_list_t), intent(in) :: list
    integer, intent(in) :: rows(2)  !< first and last
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: pair(4, block_pairs), near(4, block_pairs), curvature(block_pairs), force(3, block_pairs)
    integer :: entry(block_pairs), at, before, count, last, n, full, m, k

    last = list%first(rows(2) + 1) - 1
    do before = list%first(rows(1)) - 1, last - 1, block_pairs
      count = min(last - before, block_pairs)
      call find_ways(parcels%state, list, before, count, pair)
      n = 0
      do m = 1, count
        entry(n + 1) = before + m
        near(:, n + 1) = pair(:, m)
        n = n + merge(1, 0, sum(pair(1:3, m)**2) < (pair(4, m) + cohesion%reach)**2)
      end do
      do m = 1, n
        k = entry(m)
        curvature(m) = 1/parcels%state(radius_row, list%row(k)) + 1/parcels%state(radius_row, list%partner(k))
      end do
      full = full_lanes(n)
      do m = n + 1, full
        near(:, m) = near(:, n)
        curvature(m) = curvature(n)
      end do
      call attractions(cohesion, full, near, curvature, force)
      do m = 1, n
        at = parcels%force_at(list%row(entry(m)))
        parcels%force(at:at + 2) = parcels%force(at:at + 2) + force(:, m)
        at = parcels%force_at(list%partner(entry(m)))
        parcels%force(at:at + 2) = parcels%force(at:at + 2) - force(:, m)
      end do
    end do
  end subroutine attract_pairs

  !> x_i - x_j and r_i + r_j of the entries that follow [m].
  pure subroutine find_ways(state, list, before, count, pair)
    real(wp), intent(in), contiguous :: state(:,:)
    type(contact_list_t), intent(in) :: list
    integer, intent(in) :: before, count
    real(wp), intent(inout) :: pair(4, block_pairs)

    real(wp), parameter :: difference(4) = [-1, -1, -1, 1]
    integer :: m, l, i, j

    do m = 1, count
      i = list%row(before + m)
      j = list%partner(before + m)
      !$omp simd simdlen(4)
      do l = 1, 4
        pair(l, m) = state(l, i) + difference(l)*state(l, j)
      end do
    end do
  end subroutine find_ways

  !> Add the attraction of all walls within reach of the parcels `walls` has taken. Of meshes it is that of the nearest points
  !> that contacts have, too.
  pure subroutine attract_walls(laws, chamber, walls, parcels)
    type(contact_laws_t), intent(in) :: laws
    type(chamber_t), intent(in) :: chamber
    type(wall_list_t), intent(in) :: walls
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: way(3), distance
    integer :: kind, w, run

    do kind = 1, 3
      do w = walls%first(kind), walls%last(kind)
        associate (cohesion => laws%wall(law_of(w))%cohesion)
          if (.not. cohesion%on) cycle
          call chamber%approach(walls%face(w), parcels%state(1:3, walls%parcel(w)), way, distance)
          if (distance > 0.0_wp) call attract(cohesion, walls%parcel(w), way, distance, parcels)
        end associate
      end do
    end do
    do run = walls%first(4), walls%last(4)
      associate (range => walls%run_range(run))
        associate (cohesion => laws%wall(law_of(range(1)))%cohesion)
          if (.not. cohesion%on .or. walls%run_gap(run) > walls%way + cohesion%reach) cycle
          call attract_run(cohesion, chamber, walls, range, parcels)
        end associate
      end associate
    end do

  contains

    !> That of an entry.
    pure function law_of(w) result(law)
      integer, intent(in) :: w
      integer :: law

      law = 1
      if (size(laws%wall) > 1) law = laws%of_wall(parcels%powder(walls%parcel(w)), chamber%material_of(walls%face(w)))
    end function law_of

  end subroutine attract_walls

  !> Of one mesh on one parcel.
  pure subroutine attract_run(cohesion, chamber, walls, range, parcels)
    type(cohesion_t), intent(in) :: cohesion
    type(chamber_t), intent(in) :: chamber
    type(wall_list_t), intent(in) :: walls
    integer, intent(in) :: range(2)  !< entries
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: gap(4, range(2) - range(1) + 1)
    integer :: chosen(size(gap, 2)), n, c

    call walls%look_at_run(chamber, parcels, range, gap, chosen, n, cohesion%reach)
    associate (mesh => chamber%meshes(chamber%mesh_of(walls%face(range(1)))))
      do c = 1, n
        call attract(cohesion, walls%parcel(range(1)), mesh%turned_back(gap(1:3, chosen(c))), gap(4, chosen(c)), parcels)
      end do
    end associate
  end subroutine attract_run

  !> Of one wall on one parcel.
  pure subroutine attract(cohesion, i, way, distance, parcels)
    type(cohesion_t), intent(in) :: cohesion
    integer, intent(in) :: i          !< column of the parcel
    real(wp), intent(in) :: way(3)    !< from the wall [m]
    real(wp), intent(in) :: distance  !< its length [m]
    type(parcels_t), intent(inout) :: parcels

    real(wp) :: pair(4, lanes), curvature(lanes), force(3, lanes)
    integer :: at

    if (.not. distance < parcels%state(radius_row, i) + cohesion%reach) return
    pair = spread([way, parcels%state(radius_row, i)], 2, lanes)
    curvature = 1/parcels%state(radius_row, i)
    call attractions(cohesion, lanes, pair, curvature, force)
    at = parcels%force_at(i)
    parcels%force(at:at + 2) = parcels%force(at:at + 2) + force(:, 1)
  end subroutine attract

end module cohesion_sweep
