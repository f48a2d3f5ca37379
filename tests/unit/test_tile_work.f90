!> What tiles mean as work, in sweeps and for lists: parcels, also near walls, pairs near each other, and pairs that touch.
! ranks: 1
program test_tile_work
  use check, only: expect, expect_close, finish
  use communicator, only: communicator_t, start_ranks, stop_ranks
  use contact_settings, only: contact_settings_t
  use des_scenes, only: scene, put
  use kinds, only: wp
  use solids, only: solids_t
  use tile_work, only: work_of_tiles, kinds_of_work
  implicit none

  real(wp), parameter :: d = 1.0e-3_wp, place(3) = [3.0e-3_wp, 5.0e-3_wp, 15.0e-3_wp], far(3) = [3.0e-3_wp, 5.0e-3_wp, 5.0e-3_wp], &
    corner(3) = [0.6e-3_wp, 5.0e-3_wp, 0.6e-3_wp]
  type(communicator_t) :: comm
  real(wp) :: apart(kinds_of_work), near(kinds_of_work), touching(kinds_of_work), at_walls(kinds_of_work)

  call start_ranks(comm)
  apart = extra(5.0_wp, far)
  near = extra(1.02_wp, far)
  touching = extra(0.99_wp, far)
  at_walls = extra(5.0_wp, corner)
  call expect(all(abs(apart) < 1.0e-12_wp), 'parcels far from each other are as much work as each alone')
  call expect(abs(near(1)) < 1.0e-12_wp .and. near(2) > 0.1_wp .and. near(2) < 0.4_wp, &
              'a pair that is listed is work when lists are made, not in a sweep')
  call expect(touching(1) > 4.0_wp .and. touching(1) < 5.0_wp, 'one that touches is work in a sweep')
  call expect_close(touching(2), near(2), 1.0e-12_wp, 'and the same as another in lists')
  call expect(at_walls(1) > 8.0_wp .and. at_walls(1) < 9.0_wp, 'so is a parcel near walls, once for all of them')
  call expect(abs(at_walls(2)) < 1.0e-12_wp, 'which is nothing to lists')
  call finish()
  call stop_ranks()

contains

  !> What a pair so many diameters apart is beside its parcels, and a third one, alone in another tile, more than by itself.
  function extra(distance, third)
    real(wp), intent(in) :: distance
    real(wp), intent(in) :: third(3)  !< [m]
    real(wp) :: extra(kinds_of_work)

    real(wp), parameter :: alone(kinds_of_work) = [1.0_wp, 1.5_wp]
    type(solids_t) :: solids
    type(contact_settings_t) :: contact
    real(wp) :: x(3, 3)
    real(wp), allocatable :: work(:,:)

    contact%stiffness = 200.0_wp
    solids = scene(comm, [0.01_wp, 0.01_wp, 0.02_wp], 0.0_wp, contact)
    x = reshape([third, place, place + [distance*d, 0.0_wp, 0.0_wp]], [3, 3])
    call put(solids, x, 0*x, [d, d, d])
    work = work_of_tiles(solids%tiles, solids%parcels, solids%list, solids%walls%parcel(1:solids%walls%entries))
    extra = sum(work, 2) - 3*alone
    call expect(all(abs(work(:, solids%tiles%tile_of(third)) - alone - merge(extra, 0.0_wp, third(1) < d)) < 1.0e-12_wp), &
                'the work of a parcel alone is in its tile')
  end function extra

end program test_tile_work
