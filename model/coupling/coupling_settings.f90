!> The &coupling group: what gas and parcels do to each other.
module coupling_settings
  use case_keys, only: keys_t
  use constants, only: unset
  use drag_syamlal_obrien, only: continuous_d1
  use kinds, only: wp
  use text, only: brief, word_length
  implicit none
  private
  public :: coupling_settings_t, declare_coupling

  !> Laws of simulations that resolve the flow through an array of spheres.
  character(len=*), parameter :: fixed_arrays(4) = [character(len=word_length) :: 'beetstra', 'tang', 'tenneti', 'koch_hill']
  real(wp), parameter :: largest_jump = 0.01_wp  !< of Syamlal and O'Brien's law at its switch

  type :: coupling_settings_t
    character(len=word_length) :: drag = 'gidaspow'      !< one of drag_law's law_names
    real(wp) :: syamlal_c1 = 0.8_wp                      !< of syamlal_obrien [-]
    real(wp) :: syamlal_d1 = 2.65_wp                     !< of syamlal_obrien [-]
    character(len=word_length) :: polydispersity = 'none'  !< or 'beetstra', 'yin_sundaresan', 'cello': see sizes_*
    real(wp) :: minimum_void_fraction = 0.3_wp           !< the gas never sees less [-]
    character(len=word_length) :: mapping = 'linear'     !< 'linear' | 'cell': see mapping
    real(wp) :: width = unset                            !< standard deviation of spreading, unset: none [m]
  end type coupling_settings_t

contains

  !> The keys of the open group.
  subroutine declare_coupling(settings, keys)
    type(coupling_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    call keys%get('drag', settings%drag, 'drag law', 'wen_yu | ergun | gidaspow | gidaspow_blend | syamlal_obrien | beetstra '// &
                  '| tang | tenneti | koch_hill | di_felice | di_felice_sn | rong | cello')
    call declare_syamlal(settings, keys)
    call keys%get('polydispersity', settings%polydispersity, 'drag among particles of several sizes: none: as if all were of '// &
                  'the particle''s own size; else by its size over the mean around it', &
                  'none | beetstra | yin_sundaresan | cello')
    associate (drag => settings%drag, choice => settings%polydispersity)
      call keys%require(choice /= 'beetstra' .or. any(drag == fixed_arrays), 'polydispersity', &
                        'goes with drag = ''beetstra'', ''tang'', ''tenneti'' or ''koch_hill''')
      call keys%require(choice /= 'yin_sundaresan' .or. drag == 'beetstra', 'polydispersity', 'goes with drag = ''beetstra''')
      call keys%require(choice /= 'cello' .or. drag == 'cello', 'polydispersity', 'goes with drag = ''cello''')
    end associate
    call keys%get('minimum_void_fraction', settings%minimum_void_fraction, 'the gas never sees less [-]', '[0.05, 0.6]')
    call keys%get('mapping', settings%mapping, 'cells that a parcel touches: linear: the eight around it, by distance; '// &
                  'cell: the one it is in', 'linear | cell')
    call keys%get('width', settings%width, 'what parcels give to cells and see of them is spread by diffusion: standard '// &
                  'deviation in each direction; not given: not spread [m]', '(0, inf)')
  end subroutine declare_coupling

  !> The constants to be tuned of Syamlal and O'Brien's law.
  subroutine declare_syamlal(settings, keys)
    type(coupling_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    type(coupling_settings_t) :: usual
    real(wp) :: wanted

    call keys%get('syamlal_c1', settings%syamlal_c1, 'syamlal_obrien: to be set for the velocity of minimum fluidization [-]', &
                  '[0.1, 1.2]')
    call keys%get('syamlal_d1', settings%syamlal_d1, 'syamlal_obrien: so that c1 0.85^1.28 = 0.85^d1 [-]', '[0, 20]')
    if (settings%drag == 'syamlal_obrien') then
      wanted = continuous_d1(settings%syamlal_c1)
      call keys%require(abs(0.85_wp**(settings%syamlal_d1 - wanted) - 1.0_wp) <= largest_jump, 'syamlal_d1', &
                        'makes the law jump at a void fraction of 0.85: '//brief(wanted)//' does not')
    else
      call keys%require(.not. changed(settings%syamlal_c1, usual%syamlal_c1), 'syamlal_c1', 'belongs to drag = ''syamlal_obrien''')
      call keys%require(.not. changed(settings%syamlal_d1, usual%syamlal_d1), 'syamlal_d1', 'belongs to drag = ''syamlal_obrien''')
    end if
  end subroutine declare_syamlal

  !> Whether a value is another than the default, which the case of a restart file names like all others.
  pure function changed(value, default)
    real(wp), intent(in) :: value, default
    logical :: changed

    changed = abs(value - default) > 0.0_wp
  end function changed

end module coupling_settings
